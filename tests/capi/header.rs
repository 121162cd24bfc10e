//! `src/capi/lightoven.h` is what cbindgen makes of `src/capi`.

use crate::place::root;
use std::fs;
use std::path::Path;

/// Files of the interface, in the order of the header: what is needed is above what needs it.
const ORDER: [&str; 15] = [
    "version.rs",
    "status.rs",
    "log.rs",
    "gpu.rs",
    "scene/desc.rs",
    "scene/info.rs",
    "scene/build.rs",
    "scene/read.rs",
    "settings.rs",
    "baker.rs",
    "statistics.rs",
    "atlas.rs",
    "still.rs",
    "frames.rs",
    "changes.rs",
];

fn generated() -> String {
    let config = cbindgen::Config::from_file(root().join("src/capi/cbindgen.toml")).unwrap();
    let sources = ORDER.iter().map(|name| root().join("src/capi").join(name));
    let builder = sources.fold(cbindgen::Builder::new().with_config(config), cbindgen::Builder::with_src);
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

#[test]
fn the_header_is_that_of_the_sources() {
    let path = root().join("src/capi/lightoven.h");
    let generated = generated();
    if std::env::var("LIGHTOVEN_REGENERATE").is_ok_and(|value| value == "1") {
        fs::write(&path, &generated).unwrap();
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    let differs = committed.lines().zip(generated.lines()).find(|(old, new)| old != new);
    assert!(committed == generated, "lightoven.h is stale, at {differs:?}; LIGHTOVEN_REGENERATE=1 writes it anew");
}

/// Every function of the interface is in the header, whatever file it is in.
#[test]
fn no_function_is_left_out() {
    let header = generated();
    let mut files = vec![root().join("src/capi")];
    let mut count = 0;
    while let Some(path) = files.pop() {
        if path.is_dir() {
            files.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            count += declared(&path, &header);
        }
    }
    assert!(count > 30, "{count} functions");
}

fn declared(path: &Path, header: &str) -> usize {
    let text = fs::read_to_string(path).unwrap();
    let names: Vec<&str> = text.split("extern \"C\" fn ").skip(1).filter_map(|rest| rest.split('(').next()).collect();
    let names = names.into_iter().filter(|name| name.starts_with("lightoven_"));
    names.map(|name| assert!(header.contains(&format!("{name}(")), "{name} is not in the header")).count()
}
