//! Outputs that are never half written.

use crate::error::{Error, ErrorKind, Result};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Checks that [`write_beside`] will be able to write `path`, so that a long bake does not end in an error that could
/// have been told at once. Leaves nothing behind, and an existing file as it is.
///
/// # Errors
/// `Io`, naming the path: its folder does not exist or cannot be written, or it is something else than a file.
pub fn check_writable(path: &Path) -> Result<()> {
    create_beside(path).map(drop)
}

/// Writes a file under a temporary name in the same folder and renames it to `path` once it is complete, replacing
/// what was there, but not who may read and write it; after a failure `path` is as before. A link is followed, not replaced,
/// even where it leads to nothing yet.
///
/// # Errors
/// `Io`, naming the path, and whatever `write` fails with.
pub fn write_beside(path: &Path, write: impl FnOnce(&mut File) -> Result<()>) -> Result<()> {
    let (mut file, target) = create_beside(path)?;
    write(file.as_file_mut())?;
    #[cfg(unix)]
    if let Ok(replaced) = fs::metadata(&target) {
        // Once more: the umask has taken its share of what it was made with.
        file.as_file().set_permissions(replaced.permissions()).map_err(|error| cannot_write(path, error))?;
    }
    // On the disk before the name is: a power cut then leaves the old file or the new one.
    file.as_file().sync_all().map_err(|error| cannot_write(path, error))?;
    file.persist(target).map_err(|error| cannot_write(path, error.error))?;
    Ok(())
}

/// Links in a row, as Linux has it.
const MOST_LINKS: usize = 40;

/// Where a path leads to, through links, whether or not there is something.
fn follow(path: &Path) -> Result<PathBuf> {
    match fs::canonicalize(path) {
        Ok(target) => return Ok(target),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(cannot_write(path, error)),
    }
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        // What is no link is a new file's name, in a folder that is looked at later.
        let Ok(next) = fs::read_link(&target) else { return Ok(target) };
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(refused(path, &format!("it leads over more than {MOST_LINKS} links")))
}

fn create_beside(path: &Path) -> Result<(NamedTempFile, PathBuf)> {
    if path.as_os_str().is_empty() {
        return Err(refused(path, "the path is empty; allowed is that of a file"));
    }
    let target = follow(path)?;
    let replaced = fs::metadata(&target).ok();
    // Renaming over a device or a pipe would replace it by a file.
    if replaced.as_ref().is_some_and(|metadata| !metadata.is_file()) {
        return Err(refused(path, "it exists and is not a file"));
    }
    if target.file_name().is_none() {
        return Err(refused(path, "it ends without a file's name"));
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lightoven-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Those of what is replaced, or of any new file: the umask takes its share. A temporary file's default is 0600.
        builder.permissions(replaced.map_or(fs::Permissions::from_mode(0o666), |metadata| metadata.permissions()));
    }
    match builder.tempfile_in(folder) {
        Ok(file) => Ok((file, target)),
        Err(error) if !folder.exists() => {
            let context = format!("cannot write '{}': there is no folder '{}'", path.display(), folder.display());
            Err(Error::io(context, error))
        }
        Err(error) => Err(cannot_write(path, error)),
    }
}

fn refused(path: &Path, why: &str) -> Error {
    Error::new(ErrorKind::Io, format!("cannot write '{}': {why}", path.display()))
}

fn cannot_write(path: &Path, error: io::Error) -> Error {
    Error::io(format!("cannot write '{}'", path.display()), error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn write_text(path: &Path, text: &str) -> Result<()> {
        write_beside(path, |file| file.write_all(text.as_bytes()).map_err(|e| cannot_write(path, e)))
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("is a folder");
        entries.map(|entry| entry.expect("is readable").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_file_is_replaced_as_a_whole() {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("out");
        write_text(&path, "one").expect("can be written");
        write_text(&path, "two").expect("can be written");
        assert_eq!(fs::read_to_string(&path).expect("is there"), "two");
        let failed = write_beside(&path, |file| {
            file.write_all(b"thr").map_err(|e| cannot_write(&path, e))?;
            Err(Error::new(ErrorKind::Io, "half way"))
        });
        assert_eq!(failed.expect_err("must fail").context(), "half way");
        assert_eq!(fs::read_to_string(&path).expect("is there"), "two");
        assert_eq!(names(folder.path()), ["out"]);
    }

    #[test]
    fn what_cannot_be_written_is_told_beforehand() {
        let folder = tempfile::tempdir().expect("has room");
        let file = folder.path().join("file");
        write_text(&file, "").expect("can be written");
        let message = |path: &Path| check_writable(path).expect_err("must fail").to_string();
        let missing = folder.path().join("missing/out");
        assert!(message(&missing).contains("there is no folder") && message(&missing).contains("missing/out"));
        let under_a_file = file.join("out");
        assert!(message(&under_a_file).contains("file/out"), "{}", message(&under_a_file));
        assert!(message(folder.path()).contains("exists and is not a file"));
        assert!(message(Path::new("")).contains("the path is empty"), "{}", message(Path::new("")));
        assert!(message(&folder.path().join("missing/..")).contains("without a file's name"));
        check_writable(&folder.path().join("out")).expect("can be written");
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_are_those_of_any_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("has room");
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        write_text(&target, "old").expect("can be written");
        std::os::unix::fs::symlink(&target, &link).expect("can be linked");
        write_text(&link, "new").expect("can be written");
        assert_eq!(fs::read_to_string(&target).expect("is there"), "new");
        assert!(fs::symlink_metadata(&link).expect("is there").is_symlink());
        let plain = folder.path().join("plain");
        fs::write(&plain, "").expect("can be written");
        let mode = |path: &Path| fs::metadata(path).expect("is there").permissions().mode();
        assert_eq!(mode(&target), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_yet_stays_a_link() {
        let folder = tempfile::tempdir().expect("has room");
        let at = |name: &str| folder.path().join(name);
        let link = |target: &Path, name: &str| std::os::unix::fs::symlink(target, at(name)).expect("can be linked");
        fs::create_dir(at("below")).expect("can be made");
        // Relative to where the link is, by way of another.
        link(Path::new("below/second"), "first");
        link(Path::new("../target"), "below/second");
        check_writable(&at("first")).expect("can be written");
        write_text(&at("first"), "new").expect("can be written");
        assert_eq!(fs::read_to_string(at("target")).expect("is there"), "new");
        assert!(["first", "below/second"].iter().all(|name| fs::symlink_metadata(at(name)).expect("is").is_symlink()));
        let message = |name: &str| check_writable(&at(name)).expect_err("must fail").to_string();
        link(&at("missing/out"), "nowhere");
        assert!(message("nowhere").contains("there is no folder") && message("nowhere").contains("/missing'"));
        link(Path::new("round"), "round");
        assert!(message("round").contains("cannot write") && message("round").contains("/round'"));
    }

    #[cfg(unix)]
    #[test]
    fn who_may_read_a_file_stays_as_it_is() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("out");
        for mode in [0o600, 0o640, 0o666, 0o444] {
            fs::write(&path, "old").expect("can be written");
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).expect("is ours");
            write_text(&path, "new").expect("can be written");
            let kept = fs::metadata(&path).expect("is there").permissions().mode() & 0o7777;
            assert_eq!((kept, fs::read_to_string(&path).expect("is there").as_str()), (mode, "new"), "{mode:o}");
            fs::remove_file(&path).expect("is ours");
        }
    }
}
