//! Imports run downward only, Vulkan and unsafe code stay where they belong, and files stay small.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Modules of the library, lowest first. Those of one row do not import each other.
const LAYERS: [&[&str]; 11] = [
    &["error"],
    &["scene"],
    &["bvh"],
    &["adaptive", "clusters", "features", "epochs", "sampling", "schedule", "temporal"],
    &["gpu"],
    &["pass"],
    &["baker", "tracer"],
    &["io"],
    &["headless"],
    &["verify"],
    &["capi"],
];
/// Modules that know no Vulkan.
const PURE: [&str; 9] =
    ["adaptive", "clusters", "scene", "bvh", "features", "epochs", "sampling", "schedule", "temporal"];
const RUST_LINES: usize = 400;
const GLSL_LINES: usize = 200;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files under a folder with one of these extensions.
fn files(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| extensions.iter().any(|e| found == *e)) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty());
    found
}

/// The text without comments; what follows `//` in a string goes too.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

fn words(code: &str) -> BTreeSet<&str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_').collect()
}

/// The library's module that a file belongs to; `None`: `lib.rs`, or a binary.
fn module_of(path: &Path) -> Option<String> {
    let inside = path.strip_prefix(root().join("src")).unwrap();
    let first = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_owned();
    (first != "lib" && first != "bin").then_some(first)
}

fn layer_of(module: &str) -> usize {
    let found = LAYERS.iter().position(|layer| layer.contains(&module));
    found.unwrap_or_else(|| panic!("'{module}' has no place among the layers"))
}

/// What comes after every `crate::`, each entry of a list in braces for itself.
fn imports(code: &str) -> Vec<String> {
    let first_word =
        |text: &str| text.trim().split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap().to_owned();
    let mut found = Vec::new();
    for (place, path) in code.match_indices("crate::") {
        let rest = &code[place + path.len()..];
        let Some(list) = rest.strip_prefix('{') else {
            found.push(first_word(rest));
            continue;
        };
        let (mut depth, mut start) = (0, 0);
        for (at, c) in list.char_indices() {
            if depth == 0 && (c == ',' || c == '}') {
                found.extend(Some(first_word(&list[start..at])).filter(|word| !word.is_empty()));
                start = at + 1;
            }
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                _ => {}
            }
        }
    }
    found
}

#[test]
fn imports_are_found() {
    let code = "use crate::scene::{Mesh, Scene};\nuse crate::{\n    bvh::{Bvh, Ray},\n    error::Result,\n};\nf(crate::pass::X)";
    assert_eq!(imports(code), ["scene", "bvh", "error", "pass"]);
}

#[test]
fn imports_run_downward() {
    let mut upward = Vec::new();
    for path in files("src", &["rs"]) {
        let Some(module) = module_of(&path) else { continue };
        for import in imports(&code(&path)) {
            if import != module && layer_of(&import) >= layer_of(&module) {
                upward.push(format!("{} imports {import}", path.display()));
            }
        }
    }
    assert_eq!(upward, Vec::<String>::new());
}

#[test]
fn pure_modules_know_no_vulkan() {
    for path in files("src", &["rs"]) {
        if module_of(&path).is_some_and(|module| PURE.contains(&module.as_str())) {
            let code = code(&path);
            let vulkan: Vec<_> = words(&code).intersection(&BTreeSet::from(["ash", "vk"])).copied().collect();
            assert_eq!(vulkan, Vec::<&str>::new(), "{}", path.display());
        }
    }
}

/// The benchmark's engine: a foreign one, as far as the library can tell.
const ENGINE: &str = "src/bin/frame_bench/engine";
/// The tests' engine.
const TEST_ENGINE: &str = "tests/embed/engine";

#[test]
fn unsafe_code_is_in_the_vulkan_layer_at_the_c_boundary_and_in_engines_only() {
    for path in files("src", &["rs"]).into_iter().chain(files("tests", &["rs"])).chain([root().join("build.rs")]) {
        // This file has the word in a string.
        let allowed =
            ["src/gpu", "src/capi", ENGINE, TEST_ENGINE].iter().any(|folder| path.starts_with(root().join(folder)));
        if allowed || path == root().join(file!()) {
            continue;
        }
        assert!(!words(&code(&path)).contains("unsafe"), "{} has unsafe code", path.display());
    }
}

#[test]
fn the_benchmark_calls_vulkan_in_its_engine_only() {
    for path in files("src/bin", &["rs"]) {
        if !path.starts_with(root().join(ENGINE)) {
            let code = code(&path);
            let vulkan: Vec<_> = words(&code).intersection(&BTreeSet::from(["ash", "vk"])).copied().collect();
            assert_eq!(vulkan, Vec::<&str>::new(), "{}", path.display());
        }
    }
}

/// The compiler keeps binaries from what is private to the library, unless they take in its files.
#[test]
fn binaries_take_in_no_files_of_the_library() {
    let shaders = "include!(concat!(env!(\"OUT_DIR\"), \"/frame_bench_shaders.rs\"));";
    let binaries = fs::canonicalize(root().join("src/bin")).unwrap();
    for path in files("src/bin", &["rs"]) {
        let code = code(&path).replace(shaders, "");
        assert!(!code.contains("include!("), "{} includes a file", path.display());
        for (place, attribute) in code.match_indices("#[path = \"") {
            let other = code[place + attribute.len()..].split('"').next().unwrap();
            let other = fs::canonicalize(path.parent().unwrap().join(other)).unwrap();
            assert!(other.starts_with(&binaries), "{} takes in {}", path.display(), other.display());
        }
    }
}

#[test]
fn files_are_small() {
    let rust = files("src", &["rs"]).into_iter().chain(files("tests", &["rs"])).chain([root().join("build.rs")]);
    let glsl = files("glsl", &["glsl", "comp", "vert", "frag"]).into_iter();
    for (path, most) in rust.map(|path| (path, RUST_LINES)).chain(glsl.map(|path| (path, GLSL_LINES))) {
        let lines = fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= most, "{} has {lines} lines; allowed are {most}", path.display());
    }
}
