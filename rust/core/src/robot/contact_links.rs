//! The links that a contact is sought on.

use super::robot::{Robot, WORLD};
use crate::error::{Error, Result};

impl Robot {
    /// Whether there is a link that moves and has a surface.
    pub(crate) fn has_contact_links(&self) -> bool {
        self.moving_touchable_links().next().is_some()
    }

    /// Indices of the links that move and have a surface.
    fn moving_touchable_links(&self) -> impl Iterator<Item = usize> + '_ {
        let links = self.touchable_links().iter().map(|link| link.get());
        links.filter(|&index| self.links()[index].body != WORLD)
    }

    /// Indices, in order, of the links that move and have a surface: all of them, or those named in the argument `links`.
    /// `user` is what seeks a contact, for the message.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub(crate) fn contact_links(&self, names: Option<&[String]>, user: &str) -> Result<Vec<usize>> {
        let all: Vec<usize> = self.moving_touchable_links().collect();
        if all.is_empty() {
            let problem = format!("no link that moves has a surface; {user} needs one to look on");
            return Err(Error::input("robot", problem));
        }
        let Some(names) = names else { return Ok(all) };
        if names.is_empty() {
            return Err(Error::input("links", "must name at least one link"));
        }
        let mut wanted = Vec::with_capacity(names.len());
        for name in names {
            let found = all.iter().copied().find(|&index| &self.links()[index].name == name);
            let Some(index) = found else {
                let links: Vec<&str> = all.iter().map(|&index| self.links()[index].name.as_str()).collect();
                let problem = format!(
                    "there is no link '{name}' that moves and has a surface; there are {}",
                    links.join(", ")
                );
                return Err(Error::input("links", problem));
            };
            if !wanted.contains(&index) {
                wanted.push(index);
            }
        }
        wanted.sort_unstable();
        Ok(wanted)
    }
}
