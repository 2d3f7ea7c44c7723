//! Where a URDF's mesh files are, and which files it may name.

use std::ffi::OsString;
use std::io::{Error as IoError, ErrorKind};
use std::path::{absolute, Component, Path, PathBuf};
use std::sync::Arc;

use crate::error::{Error, Result};

const SUFFIXES: [&str; 3] = [".stl", ".obj", ".dae"];

/// Resolves one URDF's mesh file names to files inside its folder or the package folders, nowhere else.
pub(super) struct MeshFinder {
    folder: PathBuf,
    /// A package's name is that of its folder, also where a link leads to it.
    packages: Vec<(OsString, PathBuf)>,
}

impl MeshFinder {
    pub fn new(urdf: &Path, package_dirs: &[PathBuf]) -> Result<Self> {
        let unusable = |path: &Path, cause: IoError| {
            Error::input(
                "package_dirs",
                format!("must hold folders, which '{}' is not: {cause}", path.display()),
            )
        };
        let mut packages = vec![];
        for entry in package_dirs {
            let full = absolute(entry).map_err(|cause| unusable(entry, cause))?;
            let folder = resolve(&full).map_err(|cause| unusable(entry, cause))?;
            packages.push((full.file_name().unwrap_or_default().to_owned(), folder));
        }
        let folder = absolute(urdf).and_then(|full| resolve(full.parent().unwrap_or(&full)));
        let folder = folder.map_err(|cause| {
            Error::input("path", format!("must be a path to a URDF file, not '{}': {cause}", urdf.display()))
        })?;
        packages.push((folder.file_name().unwrap_or_default().to_owned(), folder.clone()));
        Ok(Self { folder, packages })
    }

    /// The file that `filename` means in `link`; [`Error::Geometry`] where missing, outside or no mesh.
    pub fn find(&self, filename: &str, link: &str) -> Result<PathBuf> {
        let owner = format!("link '{link}': mesh '{filename}'");
        let lower = filename.to_lowercase();
        if !SUFFIXES.iter().any(|suffix| lower.ends_with(suffix)) {
            let supported = SUFFIXES.join(", ");
            return Err(Error::geometry(format!("{owner} is of an unknown kind; supported: {supported}")));
        }
        let mut allowed = vec![self.folder.as_path()];
        for (_, folder) in &self.packages {
            if !allowed.contains(&folder.as_path()) {
                allowed.push(folder);
            }
        }
        let mut inside = vec![];
        for candidate in self.candidates(filename, &owner)? {
            let path = resolve(&candidate).map_err(|cause| {
                let text = format!("{owner} is not a usable file name: {cause}");
                Error::geometry(text).because(Some(Arc::new(cause)))
            })?;
            if allowed.iter().any(|folder| path.starts_with(folder)) {
                if path.is_file() {
                    return Ok(path);
                }
                inside.push(path);
            }
        }
        Err(Error::geometry(if inside.is_empty() {
            format!(
                "{owner} lies outside the folders it may come from, {}; move it there or add its folder to \
                 package_dirs",
                listing(&allowed)
            )
        } else {
            format!("{owner} was not found; looked for {} (see package_dirs)", listing(&inside))
        }))
    }

    fn candidates(&self, filename: &str, owner: &str) -> Result<Vec<PathBuf>> {
        let (scheme, rest) = match filename.split_once("://") {
            None => return Ok(vec![self.folder.join(filename)]),
            Some(("file", rest)) => return Ok(vec![self.folder.join(rest)]),
            Some(parts) => parts,
        };
        if scheme != "package" {
            return Err(Error::geometry(format!(
                "{owner} has the unknown scheme '{scheme}://'; supported: package://, file://, a path"
            )));
        }
        // "package:///pkg/file" is seen in the wild.
        let rest = rest.trim_start_matches('/');
        let (package, inner) = rest.split_once('/').unwrap_or((rest, ""));
        let mut candidates = vec![];
        for (name, folder) in &self.packages {
            candidates.push(folder.join(package).join(inner));
            if package == name.as_os_str() || folder.file_name().is_some_and(|own| package == own) {
                candidates.push(folder.join(inner.trim_start_matches('/')));
            }
        }
        Ok(candidates)
    }
}

/// An absolute path without symbolic links and `..`; what does not exist is taken as written.
fn resolve(path: &Path) -> std::io::Result<PathBuf> {
    let mut resolved = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => {
                resolved.pop();
            }
            Component::CurDir => {}
            other => {
                resolved.push(other);
                match resolved.canonicalize() {
                    Ok(real) => resolved = real,
                    Err(cause) if matches!(cause.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {}
                    Err(cause) => return Err(cause),
                }
            }
        }
    }
    Ok(resolved)
}

fn listing<P: AsRef<Path>>(paths: &[P]) -> String {
    let shown: Vec<String> = paths.iter().map(|path| format!("'{}'", path.as_ref().display())).collect();
    shown.join(", ")
}
