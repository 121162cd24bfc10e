//! The library as engines get it: built and installed by the README's commands.

use crate::place::{readme_block, root};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Where it is installed: `include`, `lib`, `lib/pkgconfig` and `lib/cmake`.
pub(crate) fn prefix() -> &'static Path {
    static PREFIX: OnceLock<PathBuf> = OnceLock::new();
    PREFIX.get_or_init(|| {
        let prefix = Path::new(env!("CARGO_TARGET_TMPDIR")).join("capi");
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
        let mut shell = Command::new("sh");
        shell.args(["-euc", &readme_block("capi:install")]).current_dir(root());
        shell.env("PREFIX", &prefix).env("CARGO_TARGET_DIR", target).env_remove("CARGO_MANIFEST_DIR");
        run(&mut shell);
        prefix
    })
}

/// Runs a command that has to succeed; gives what it printed.
pub(crate) fn run(command: &mut Command) -> String {
    let (success, text) = outcome(command);
    assert!(success == Some(0), "{command:?} ended with {success:?}:\n{text}");
    text
}

/// The exit code, and what was printed to both streams.
pub(crate) fn outcome(command: &mut Command) -> (Option<i32>, String) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    (output.status.code(), text)
}

/// What pkg-config says of the installed library.
pub(crate) fn pkg_config(arguments: &[&str]) -> Vec<String> {
    let mut command = Command::new("pkg-config");
    command.args(arguments).arg("lightoven").env("PKG_CONFIG_PATH", prefix().join("lib/pkgconfig"));
    run(&mut command).split_whitespace().map(str::to_owned).collect()
}

/// How an engine is linked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Linked {
    Shared,
    Static,
}

/// What a source is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Language {
    C,
    Cpp,
}

/// Compiles an engine of this folder, in the language that its name tells; a warning is an error.
pub(crate) fn compile(source: &str, linked: Linked, more: &[&str]) -> PathBuf {
    let language = if source.ends_with(".cpp") { Language::Cpp } else { Language::C };
    compile_as(language, source, linked, more)
}

/// As [`compile`], in this language.
pub(crate) fn compile_as(language: Language, source: &str, linked: Linked, more: &[&str]) -> PathBuf {
    let source = root().join("tests/capi").join(source);
    let is_cpp = language == Language::Cpp;
    let name = format!("{}-{language:?}-{linked:?}{}", source.file_name().unwrap().to_string_lossy(), more.join(""));
    let program = prefix().join(name.replace('.', "-"));
    let host = format!("{}-unknown-{}-gnu", std::env::consts::ARCH, std::env::consts::OS);
    let mut build = cc::Build::new();
    build.cpp(is_cpp).cargo_metadata(false).target(&host).host(&host).opt_level(1).debug(true);
    let mut command = build.get_compiler().to_command();
    command.args(["-Wall", "-Wextra", "-Werror", if is_cpp { "-std=c++17" } else { "-std=c11" }]).args(more);
    command.args(["-x", if is_cpp { "c++" } else { "c" }]).arg(&source).args(["-x", "none"]);
    command.arg("-o").arg(&program).args(pkg_config(&["--cflags"]));
    match linked {
        Linked::Shared => {
            let folder = prefix().join("lib");
            command.args(pkg_config(&["--libs"])).arg(format!("-Wl,-rpath,{}", folder.display()));
        }
        Linked::Static => {
            // Not -llightoven, which would find the shared one first.
            command.arg(prefix().join("lib/liblightoven.a"));
            let libraries = pkg_config(&["--libs-only-l", "--static"]);
            command.args(libraries.iter().filter(|library| *library != "-llightoven"));
        }
    }
    run(command.arg("-ldl"));
    program
}
