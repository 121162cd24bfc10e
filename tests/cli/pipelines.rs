//! Compiled pipelines that are kept in the user's folder.

use crate::support::{Folder, Run, asset, tool};
use std::fs;

/// Bakes with `folder` for the user's.
fn bake(folder: &Folder, variable: &str) -> Run {
    let output = folder.text("out.exr");
    let arguments = ["bake", &asset("cornell.gltf"), "-o", &output, "--resolution", "32", "--samples", "16"];
    let mut tool = tool(arguments);
    tool.env_remove("LIGHTOVEN_PIPELINE_CACHE").env_remove("XDG_CACHE_HOME").env_remove("HOME");
    // Mesa's own folder stays where it was: compiling everything anew takes lavapipe many seconds.
    if let Some(home) = std::env::home_dir() {
        tool.env("MESA_SHADER_CACHE_DIR", home.join(".cache"));
    }
    let run: Run = tool.env(variable, folder.text("user")).output().expect("the tool starts").into();
    assert_eq!(run.code, Some(0), "{run:?}");
    run
}

/// The one file below `user`.
fn kept(folder: &Folder, below: &str) -> std::path::PathBuf {
    let mut entries = fs::read_dir(folder.path("user").join(below)).expect("is a folder");
    let file = entries.next().expect("has a file").expect("is readable").path();
    assert!(entries.next().is_none());
    file
}

#[test]
fn are_read_and_written() {
    let folder = Folder::new();
    bake(&folder, "XDG_CACHE_HOME");
    let file = kept(&folder, "lightoven");
    let bytes = fs::read(&file).expect("is readable");
    let again = bake(&folder, "XDG_CACHE_HOME");
    assert!(!again.stderr.contains("pipeline"), "{}", again.stderr);
    // A damaged file is said, and mended.
    fs::write(&file, &bytes[..bytes.len() - 1]).expect("can be written");
    let warned = bake(&folder, "XDG_CACHE_HOME");
    assert!(warned.stderr.contains("the pipeline cache is left aside"), "{}", warned.stderr);
    assert!(!bake(&folder, "XDG_CACHE_HOME").stderr.contains("pipeline"));
}

#[test]
fn are_kept_at_home() {
    let folder = Folder::new();
    bake(&folder, "HOME");
    assert!(kept(&folder, ".cache/lightoven").extension().is_some_and(|extension| extension == "pipelines"));
}

#[test]
fn are_kept_nowhere_without_a_user() {
    let folder = Folder::new();
    bake(&folder, "LIGHTOVEN_UNKNOWN");
    assert_eq!(folder.names(), ["out.exr"]);
}
