//! Where things are.

use std::fs;
use std::path::Path;

/// The project's folder.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The code block of the README after `<!-- marker -->`.
pub(crate) fn readme_block(marker: &str) -> String {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let marker = format!("<!-- {marker} -->");
    let after = readme.split_once(&marker).unwrap_or_else(|| panic!("README.md has no {marker}")).1;
    let block = after.split_once("```").and_then(|(_, rest)| rest.split_once('\n')).unwrap().1;
    block.split_once("```").unwrap().0.to_owned()
}
