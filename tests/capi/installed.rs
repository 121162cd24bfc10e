//! What the README says of pkg-config and CMake is so.

use crate::library::{Language, Linked, compile_as, pkg_config, prefix, run};
use crate::place::{readme_block, root};
use std::fs;
use std::process::Command;

#[test]
fn pkg_config_knows_it() {
    assert_eq!(pkg_config(&["--modversion"]), [env!("CARGO_PKG_VERSION")]);
    let library = prefix().join("lib/liblightoven.so");
    let names = run(Command::new("readelf").arg("--dynamic").arg(&library));
    let soname =
        concat!("[liblightoven.so.", env!("CARGO_PKG_VERSION_MAJOR"), ".", env!("CARGO_PKG_VERSION_MINOR"), "]");
    assert!(names.contains("SONAME") && names.contains(soname), "{names}");
    let config = fs::read_to_string(root().join("src/capi/lightoven-config.cmake")).unwrap();
    let version = fs::read_to_string(root().join("src/capi/lightoven-config-version.cmake")).unwrap();
    let number = concat!("set(PACKAGE_VERSION ", env!("CARGO_PKG_VERSION"), ")");
    assert!(version.contains(number), "lightoven-config-version.cmake has another version");
    assert!(config.contains(soname.trim_matches(['[', ']'])), "lightoven-config.cmake has another version");
}

/// Exported are the interface's functions and nothing else.
#[test]
fn nothing_else_is_exported() {
    let library = prefix().join("lib/liblightoven.so");
    let symbols = run(Command::new("nm").args(["--dynamic", "--defined-only", "--format=posix"]).arg(library));
    let names: Vec<&str> = symbols.lines().filter_map(|line| line.split(' ').next()).collect();
    let others: Vec<_> = names.iter().filter(|name| !name.starts_with("lightoven_")).collect();
    assert!(names.len() > 30 && others.is_empty(), "{others:?}");
}

/// The README's project and its code, once with each library.
#[test]
fn cmake_builds_the_readmes_project() {
    for target in ["lightoven::lightoven", "lightoven::static"] {
        let folder = tempfile::tempdir().unwrap();
        let project = readme_block("capi:cmake").replace("lightoven::lightoven)", &format!("{target})"));
        fs::write(folder.path().join("CMakeLists.txt"), project).unwrap();
        let main = "int main() { return bake(LightovenGpuDesc{}, \"\").empty() ? 0 : 1; }\n";
        fs::write(folder.path().join("engine.cpp"), readme_block("capi:engine") + main).unwrap();
        let build = folder.path().join("build");
        let mut configure = Command::new("cmake");
        configure.arg("-S").arg(folder.path()).arg("-B").arg(&build);
        run(configure
            .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix().display()))
            .arg("-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror"));
        run(Command::new("cmake").arg("--build").arg(&build));
        let said = run(&mut Command::new(build.join("engine")));
        assert!(said.contains("the size of the description of the GPU, a LightovenGpuDesc, is 0"), "{said}");
    }
}

/// The header alone, as the first thing that is included, in both languages.
#[test]
fn the_header_stands_alone() {
    for (language, linked) in [(Language::C, Linked::Shared), (Language::Cpp, Linked::Static)] {
        let said = run(&mut Command::new(compile_as(language, "header.c", linked, &[])));
        assert_eq!(said.trim(), env!("CARGO_PKG_VERSION"));
    }
}
