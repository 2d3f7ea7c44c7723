//! Links as a tree.

use crate::error::{Error, Result};
use crate::robot::Link;

/// Parents exist, lead to a root, and sit on the link's own body or one that carries it.
pub(crate) fn check_link_tree(links: &[Link], chains: &[Vec<usize>]) -> Result<()> {
    for link in links {
        let owner = format!("link '{}'", link.name);
        let refuse = |text: &str| Err(Error::model(format!("{owner}: {text}")).of(&owner));
        let mut ancestor = link.parent;
        for _ in 0..links.len() {
            match ancestor {
                Some(index) if index < links.len() => ancestor = links[index].parent,
                Some(_) => return refuse("a parent link does not exist"),
                None => break,
            }
        }
        if ancestor.is_some() {
            return refuse("the links must form a tree; its parents form a cycle");
        }
        if let Some(parent) = link.parent.map(|index| &links[index]) {
            if parent.body != 0 && !chains[link.body].contains(&parent.body) {
                return refuse("its parent link must sit on the same body or one that carries it");
            }
        }
    }
    Ok(())
}
