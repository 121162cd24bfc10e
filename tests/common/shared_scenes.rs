//! Real game levels, where they lie beside the project.

use std::path::{Path, PathBuf};

/// `None`, and a message, where the level is absent.
pub(crate) fn shared_scene(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes").join(name);
    if !path.exists() {
        println!("skipped: {} is absent", path.display());
    }
    path.exists().then_some(path)
}
