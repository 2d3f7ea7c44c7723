//! Where a URDF's mesh files are, and which files it may name.

use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use super::options::MissingMeshes;
use crate::error::{Error, Result};

const SUFFIXES: [&str; 3] = [".stl", ".obj", ".dae"];
/// Most files and folders that are looked through for a mesh file of another machine's path.
const MOST_ENTRIES: usize = 100_000;

/// Resolves one URDF's mesh file names to files inside its folder or the package folders, nowhere else.
pub(super) struct MeshFinder {
    /// The URDF's folder first; a package's name is that of its folder, also where a link leads to it.
    folders: Vec<(String, PathBuf)>,
    /// All mesh files in them, once they are needed.
    files: Option<Vec<PathBuf>>,
}

impl MeshFinder {
    pub fn new(urdf: &Path, package_dirs: &[PathBuf]) -> Self {
        let parent = urdf.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut folders = vec![];
        for folder in [parent].into_iter().chain(package_dirs.iter().map(PathBuf::as_path)) {
            let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
            folders.push((name, folder.canonicalize().unwrap_or_else(|_| folder.to_owned())));
        }
        Self { folders, files: None }
    }

    /// The file that `filename` means, none where it is missing and may be.
    ///
    /// [`Error::Geometry`], which `owner` opens, where it is missing, lies outside, or is no mesh.
    pub fn find(
        &mut self,
        filename: &str,
        owner: &str,
        missing: MissingMeshes,
        warnings: &mut Vec<String>,
    ) -> Result<Option<PathBuf>> {
        if !SUFFIXES.iter().any(|suffix| filename.to_lowercase().ends_with(suffix)) {
            let text = format!("{owner} is of an unknown kind; supported: {}", SUFFIXES.join(", "));
            return Err(Error::geometry(text));
        }
        let is_inside = |path: &Path| self.folders.iter().any(|(_, folder)| path.starts_with(folder));
        let mut inside = vec![];
        for candidate in self.candidates(filename, owner)? {
            match candidate.canonicalize() {
                Ok(path) if path.is_file() && is_inside(&path) => return Ok(Some(path)),
                Ok(path) => inside.extend(is_inside(&path).then_some(path)),
                Err(cause) if matches!(cause.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                    let path = without_dots(&candidate);
                    inside.extend(is_inside(&path).then_some(path));
                }
                Err(cause) => {
                    let text = format!("{owner} is not a usable file name: {cause}");
                    return Err(Error::geometry(text).because(Some(Arc::new(cause))));
                }
            }
        }
        if let Some(path) = self.with_longest_tail(filename) {
            warnings.push(format!("{owner} is taken from '{}', whose path ends alike", path.display()));
            return Ok(Some(path));
        }
        let listing = |paths: &mut dyn Iterator<Item = &PathBuf>| {
            paths.map(|path| format!("'{}'", path.display())).collect::<Vec<_>>().join(", ")
        };
        let problem = if inside.is_empty() {
            format!(
                "{owner} lies outside the folders it may come from, {}; move it there or add its folder to \
                 package_dirs",
                listing(&mut self.folders.iter().map(|(_, folder)| folder))
            )
        } else {
            format!("{owner} was not found; looked for {} (see package_dirs)", listing(&mut inside.iter()))
        };
        match missing {
            MissingMeshes::Error => Err(Error::geometry(problem)),
            MissingMeshes::Warn => {
                warnings.push(format!("{problem}; the link has no surface there"));
                Ok(None)
            }
        }
    }

    fn candidates(&self, filename: &str, owner: &str) -> Result<Vec<PathBuf>> {
        let own = &self.folders[0].1;
        let (scheme, rest) = match filename.split_once("://") {
            None => return Ok(vec![own.join(filename)]),
            Some(("file", rest)) => return Ok(vec![own.join(rest)]),
            Some(parts) => parts,
        };
        if scheme != "package" {
            let text = format!(
                "{owner} has the unknown scheme '{scheme}://'; supported: package://, file://, a path"
            );
            return Err(Error::geometry(text));
        }
        // "package:///pkg/file" is seen in the wild.
        let rest = rest.trim_start_matches('/');
        let (package, inner) = rest.split_once('/').unwrap_or((rest, ""));
        let mut candidates = vec![];
        for (name, folder) in &self.folders {
            candidates.push(folder.join(rest));
            if package == name || folder.file_name().is_some_and(|own| package == own) {
                candidates.push(folder.join(inner.trim_start_matches('/')));
            }
        }
        // A package's files that were copied beside its URDF, in a folder of another name.
        if package != ".." {
            candidates.push(own.join(inner.trim_start_matches('/')));
        }
        Ok(candidates)
    }

    /// Of an absolute path, perhaps of another machine: the file in the folders with the most path components in
    /// common, counted from the end.
    fn with_longest_tail(&mut self, filename: &str) -> Option<PathBuf> {
        let wanted = Path::new(filename.strip_prefix("file://").unwrap_or(filename));
        if !wanted.is_absolute() {
            return None;
        }
        let files = self.files.get_or_insert_with(|| mesh_files(&self.folders));
        let tail = |path: &PathBuf| {
            path.components().rev().zip(wanted.components().rev()).take_while(|(a, b)| a == b).count()
        };
        let longest = files.iter().map(tail).max().filter(|longest| *longest > 0)?;
        files.iter().find(|path| tail(path) == longest).cloned()
    }
}

/// A path whose `..` are taken as written.
fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => drop(plain.pop()),
            other => plain.push(other),
        }
    }
    plain
}

/// All mesh files below some folders, in a fixed order; links are not followed.
fn mesh_files(folders: &[(String, PathBuf)]) -> Vec<PathBuf> {
    let mut ahead: Vec<PathBuf> = folders.iter().map(|(_, folder)| folder.clone()).collect();
    let (mut files, mut entries) = (vec![], 0);
    while let Some(folder) = ahead.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            entries += 1;
            match entry.file_type() {
                _ if entries > MOST_ENTRIES => return files,
                Ok(kind) if kind.is_dir() => ahead.push(entry.path()),
                Ok(kind) if kind.is_file() => files.push(entry.path()),
                _ => {}
            }
        }
    }
    files.sort();
    files
}
