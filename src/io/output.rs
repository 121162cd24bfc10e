//! Outputs that are never half written.

use crate::error::{Error, ErrorKind, Result};
use std::fs::{self, File, Metadata};
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

/// Writes a file under a temporary name in the same folder and renames it to `path` once it is complete. What was there is
/// replaced and its mode kept, as far as reading, writing and running go; its owner and access lists are not. After a failure
/// `path` is as before. A link is followed, not replaced, even where it leads to nothing yet.
///
/// # Errors
/// `Io`, naming the path, and whatever `write` fails with.
pub fn write_beside(path: &Path, write: impl FnOnce(&mut File) -> Result<()>) -> Result<()> {
    let Beside { mut file, target, replaced } = create_beside(path)?;
    write(file.as_file_mut())?;
    #[cfg(unix)]
    if let Some(replaced) = replaced {
        keep_mode(path, file.as_file(), mode_of(&replaced));
    }
    #[cfg(not(unix))]
    drop(replaced);
    // On the disk before the name is: a power cut then leaves the old file or the new one.
    file.as_file().sync_all().map_err(|error| cannot_write(path, error))?;
    file.persist(target).map_err(|error| cannot_write(path, error.error))?;
    Ok(())
}

/// A temporary file, and what its name will be.
struct Beside {
    file: NamedTempFile,
    target: PathBuf,
    /// What has that name now.
    replaced: Option<Metadata>,
}

/// Without the bits that let others run a file as its owner or group.
#[cfg(unix)]
fn mode_of(metadata: &Metadata) -> u32 {
    use std::os::unix::fs::PermissionsExt;
    metadata.permissions().mode() & 0o777
}

/// Once more: the umask has taken its share of what the file was made with. There are file systems without modes, and what is
/// to be written is worth more than its mode.
#[cfg(unix)]
fn keep_mode(path: &Path, file: &File, wanted: u32) {
    use std::os::unix::fs::PermissionsExt;
    if file.metadata().is_ok_and(|metadata| metadata.permissions().mode() & 0o7777 == wanted) {
        return;
    }
    if let Err(error) = file.set_permissions(fs::Permissions::from_mode(wanted)) {
        tracing::debug!("'{}' does not keep its mode, {wanted:o}: {error}", path.display());
    }
}

/// Links in a row, as Linux has it.
const MOST_LINKS: usize = 40;

/// Where a path leads to, through links, and what is there.
fn follow(path: &Path) -> Result<(PathBuf, Option<Metadata>)> {
    match fs::metadata(path) {
        // Renaming over a device or a pipe would replace it by a file.
        Ok(metadata) if !metadata.is_file() => Err(refused(path, "it exists and is not a file")),
        Ok(metadata) => Ok((name_of(path, &metadata)?, Some(metadata))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok((follow_to_nothing(path)?, None)),
        Err(error) => Err(cannot_write(path, error)),
    }
}

/// The name of a file that is there. Links of /proc lead to files that may have none any more, and their texts elsewhere.
fn name_of(path: &Path, metadata: &Metadata) -> Result<PathBuf> {
    match fs::canonicalize(path) {
        Ok(name) if fs::metadata(&name).is_ok_and(|named| is_same(&named, metadata)) => Ok(name),
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(cannot_write(path, error)),
        _ => Err(refused(path, "it is a file without a name: deleted, or never on a disk")),
    }
}

#[cfg(unix)]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// There are no links of /proc.
#[cfg(not(unix))]
fn is_same(_one: &Metadata, _other: &Metadata) -> bool {
    true
}

/// Where a path leads to where nothing is.
fn follow_to_nothing(path: &Path) -> Result<PathBuf> {
    let mut target = path.to_path_buf();
    // One look more than there are links: at the name in the end.
    for _ in 0..=MOST_LINKS {
        // What is no link is a new file's name, in a folder that is looked at later.
        let Ok(next) = fs::read_link(&target) else { return Ok(target) };
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(refused(path, &format!("it leads over more than {MOST_LINKS} links")))
}

/// Whether a path ends in a name, and not in what only a folder may: "new/" and "new/." are to [`Path`] as "new" is.
fn ends_in_a_name(path: &Path) -> bool {
    let bytes = path.as_os_str().as_encoded_bytes();
    let is_separator = |byte: &u8| std::path::is_separator(char::from(*byte));
    let end = bytes.strip_suffix(b".").filter(|rest| rest.last().is_none_or(is_separator)).unwrap_or(bytes);
    path.file_name().is_some() && !end.last().is_some_and(is_separator)
}

fn create_beside(path: &Path) -> Result<Beside> {
    if path.as_os_str().is_empty() {
        return Err(refused(path, "the path is empty; allowed is that of a file"));
    }
    let (target, replaced) = follow(path)?;
    if !ends_in_a_name(&target) {
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
        // That of what is replaced, or of any new file: the umask takes its share. A temporary file's default is 0600.
        builder.permissions(fs::Permissions::from_mode(replaced.as_ref().map_or(0o666, mode_of)));
    }
    match builder.tempfile_in(folder) {
        Ok(file) => Ok(Beside { file, target, replaced }),
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
        for nameless in ["missing/..", "new.exr/", "new.exr//", "new.exr/."] {
            let message = message(&folder.path().join(nameless));
            assert!(message.contains("without a file's name") && message.contains(nameless), "{message}");
        }
        assert!(["new", "new.", "new..", ".new", "a/.new"].iter().all(|name| ends_in_a_name(Path::new(name))));
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
        // What the rename would refuse.
        link(Path::new("new"), "dangling");
        link(Path::new("new/"), "to a folder");
        for nameless in ["dangling/", "dangling/.", "to a folder"] {
            assert!(message(nameless).contains("without a file's name"), "{}", message(nameless));
        }
        link(Path::new("round"), "round");
        assert!(message("round").contains("cannot write") && message("round").contains("/round'"));
    }

    /// As many as the system follows, and no more.
    #[cfg(target_os = "linux")]
    #[test]
    fn links_in_a_row_are_followed_as_the_system_does() {
        let folder = tempfile::tempdir().expect("has room");
        let at = |number: usize| folder.path().join(number.to_string());
        for number in 1..=MOST_LINKS + 1 {
            std::os::unix::fs::symlink(at(number - 1), at(number)).expect("can be linked");
        }
        check_writable(&at(MOST_LINKS)).expect("can be written");
        let message = check_writable(&at(MOST_LINKS + 1)).expect_err("must fail").to_string();
        assert!(message.contains("cannot write") && message.contains("/41'"), "{message}");
        write_text(&at(MOST_LINKS), "new").expect("can be written");
        assert_eq!(fs::read_to_string(at(0)).expect("is there"), "new");
    }

    /// Links of /proc lead to files whatever their texts say.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_has_no_name_is_not_written() {
        use std::os::fd::AsRawFd;
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("out");
        let link = |file: &dyn AsRawFd| PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()));
        let message = |path: &Path| check_writable(path).expect_err("must fail").to_string();
        let file = File::create(&path).expect("can be written");
        check_writable(&link(&file)).expect("has a name");
        fs::remove_file(&path).expect("is ours");
        assert!(message(&link(&file)).contains("a file without a name"), "{}", message(&link(&file)));
        assert!(names(folder.path()).is_empty());
        // Another file has the name that the link's text says.
        fs::write(folder.path().join("out (deleted)"), "other").expect("can be written");
        assert!(message(&link(&file)).contains("a file without a name"), "{}", message(&link(&file)));
        let (_reader, writer) = io::pipe().expect("can be made");
        assert!(message(&link(&writer)).contains("exists and is not a file"), "{}", message(&link(&writer)));
    }

    #[cfg(unix)]
    #[test]
    fn a_mode_is_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("out");
        for mode in [0o600, 0o640, 0o666, 0o444, 0o755, 0o6755, 0o1644] {
            fs::write(&path, "old").expect("can be written");
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).expect("is ours");
            write_text(&path, "new").expect("can be written");
            let kept = fs::metadata(&path).expect("is there").permissions().mode() & 0o7777;
            let text = fs::read_to_string(&path).expect("is there");
            assert_eq!((kept, text.as_str()), (mode & 0o777, "new"), "{mode:o}");
            fs::remove_file(&path).expect("is ours");
        }
    }
}
