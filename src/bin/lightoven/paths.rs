//! Checks outputs before any work is done.

use lightoven::io::check_writable;
use lightoven::{Error, ErrorKind, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// A path as the command line names it.
pub(crate) type Named<'a> = (&'a str, Option<&'a PathBuf>);

/// `Ok` when every output can be written and is neither an input nor another output.
pub(crate) fn check(inputs: &[Named<'_>], outputs: &[Named<'_>]) -> Result<()> {
    let mut taken: Vec<(&str, PathBuf)> =
        inputs.iter().filter_map(|(name, path)| Some((*name, identity(path.as_ref()?)))).collect();
    for (name, path) in outputs {
        let Some(path) = path else { continue };
        let identity = identity(path);
        if let Some((other, _)) = taken.iter().find(|(_, taken)| *taken == identity) {
            let context = format!("{name} is '{}', the same file as {other}; allowed is another", path.display());
            return Err(Error::new(ErrorKind::InvalidSettings, context));
        }
        taken.push((name, identity));
        check_writable(path)?;
    }
    Ok(())
}

/// One path for a file, however it is spelled, whether it exists or not.
fn identity(path: &Path) -> PathBuf {
    let through_folder = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(through_folder).unwrap_or_else(|| path.to_path_buf())
}
