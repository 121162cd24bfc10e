//! Bytes from files and URIs.

use crate::error::{Error, ErrorKind, Result};
use gltf::buffer::{Data, Source};
use std::path::Path;

/// Reads a whole file.
///
/// Pipes and devices, which may never end, and folders are refused.
pub(super) fn read_file(path: &Path, what: impl Fn() -> String) -> Result<Vec<u8>> {
    let context = || format!("read {} '{}'", what(), path.display());
    let metadata = std::fs::metadata(path).map_err(|error| Error::io(context(), error))?;
    if !metadata.is_file() {
        let found = if metadata.is_dir() { "a folder" } else { "no regular file" };
        return Err(Error::new(ErrorKind::Io, format!("{}: it is {found}; allowed is a file", context())));
    }
    std::fs::read(path).map_err(|error| Error::io(context(), error))
}

/// Reads what a URI refers to: a `data:` URI's own bytes, or a file relative to `folder`; without a folder no file.
pub(super) fn read_uri(uri: &str, folder: Option<&Path>, what: impl Fn() -> String) -> Result<Vec<u8>> {
    if uri.starts_with("data:") {
        let data = Data::from_source(Source::Uri(uri), None);
        let fail = |error| Error::scene(format!("{}: its data URI is not base64", what())).with_source(error);
        return data.map(|data| data.0).map_err(fail);
    }
    if let Some(scheme) = scheme(uri) {
        return Err(Error::new(
            ErrorKind::Unsupported,
            format!("{}: the scheme of its URI '{uri}' is '{scheme}'; allowed are 'data' and relative paths", what()),
        ));
    }
    let Some(relative) = percent_decode(uri) else {
        return Err(Error::scene(format!("{}: its URI '{uri}' is not percent-encoded UTF-8", what())));
    };
    if relative.is_empty() || relative.contains('\0') {
        return Err(Error::scene(format!("{}: its URI '{uri}' names no file", what())));
    }
    if Path::new(&relative).has_root() {
        return Err(Error::scene(format!("{}: its URI '{uri}' is absolute; allowed are relative paths", what())));
    }
    let Some(folder) = folder else {
        return Err(Error::scene(format!(
            "{}: its URI '{uri}' names a file; allowed in a file in memory, of no folder, are 'data' URIs",
            what()
        )));
    };
    read_file(&folder.join(relative), what)
}

/// What stands before the first colon, unless the colon is in a path.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let is_scheme = scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    (is_scheme && !scheme.is_empty()).then_some(scheme)
}

/// `None` for bytes that are not UTF-8; a percent sign that no two hexadecimal digits follow stands for itself.
fn percent_decode(uri: &str) -> Option<String> {
    let digit = |byte: &u8| char::from(*byte).to_digit(16).map(|digit| digit as u8);
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let encoded = match tail {
            [high, low, ..] if *first == b'%' => digit(high).zip(digit(low)).map(|(high, low)| high * 16 + low),
            _ => None,
        };
        bytes.push(encoded.unwrap_or(*first));
        rest = if encoded.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_encoding_is_undone() {
        assert_eq!(percent_decode("a%20b%C3%A9.bin").as_deref(), Some("a bé.bin"));
        assert_eq!(percent_decode("100%").as_deref(), Some("100%"));
        assert_eq!(percent_decode("%zz%4").as_deref(), Some("%zz%4"));
        assert_eq!(percent_decode("%ff"), None);
    }

    #[test]
    fn schemes_are_told_from_paths() {
        assert_eq!(scheme("https://a/b.bin"), Some("https"));
        assert_eq!(scheme("folder/a:b.bin"), None);
        assert_eq!(scheme("a.bin"), None);
    }
}
