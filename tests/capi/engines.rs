//! Engines in C and C++ bake as the Rust interface does, to the bit.

use crate::engine::Engine;
use crate::library::{Linked, compile, outcome, run};
use crate::place::root;
use crate::reference::{self, Way};
use lightoven::baker::LightMap;
use lightoven::gpu::BackendChoice;
use std::fs;
use std::path::Path;
use std::process::Command;

/// As the header counts them.
const BACKENDS: [(BackendChoice, &str); 2] = [(BackendChoice::Software, "1"), (BackendChoice::RayQuery, "2")];

/// What the engine says where the device has no such back end.
const SKIPPED: i32 = 77;

/// Runs an engine; false where it was skipped, which nobody may insist on.
fn runs(program: &Path, folder: &Path, backend: &str, more: &[&Path]) -> bool {
    let mut command = Command::new(program);
    command.arg(folder).arg(backend).args(more);
    let (code, text) = outcome(&mut command);
    println!("{text}");
    let required = std::env::var("LIGHTOVEN_REQUIRE").is_ok_and(|required| required == "ray_query");
    if code == Some(SKIPPED) && backend == "2" && !required {
        return false;
    }
    assert_eq!(code, Some(0), "{command:?}: {text}");
    true
}

/// The map that an engine wrote is this one, and something is lit.
fn same(folder: &Path, name: &str, light_map: &LightMap) {
    let written = fs::read(folder.join(name)).unwrap();
    let expected: Vec<u8> = light_map.pixels.iter().flatten().flat_map(|value| value.to_ne_bytes()).collect();
    assert_eq!(written.len(), expected.len(), "{name}");
    let differ = written.chunks(16).zip(expected.chunks(16)).filter(|(one, other)| one != other).count();
    assert_eq!(differ, 0, "{name}: {differ} texels of {} differ", light_map.pixels.len());
    let lit = light_map.pixels.iter().filter(|pixel| pixel[1] > 0.0).count();
    assert!(lit > 1000, "{name}: {lit} texels are lit");
    println!("{name}: {} texels, the same to the bit, {lit} of them lit", light_map.pixels.len());
}

#[test]
fn an_engine_in_c() {
    let program = compile("engine.c", Linked::Shared, &[]);
    for (choice, backend) in BACKENDS {
        let folder = tempfile::tempdir().unwrap();
        if !runs(&program, folder.path(), backend, &[]) {
            continue;
        }
        let mut engine = Engine::new(choice).unwrap();
        let still = reference::still(&engine, &reference::scene(), 7, 128);
        same(folder.path(), "still.bin", &still);
        let (width, height, pixels) = lightoven::io::exr::read_image(&folder.path().join("still.exr")).unwrap();
        assert_eq!(LightMap { width, height, pixels }, still);
        let left_out = fs::read_to_string(folder.path().join("left_out.txt")).unwrap();
        assert_eq!(left_out, reference::left_out(&engine, &reference::scene(), 7));
        println!("left out:\n{left_out}");
        same(folder.path(), "frames.bin", &reference::frames(&mut engine, Way::Record));
        engine.finish();
    }
}

#[test]
fn an_engine_in_cpp() {
    let program = compile("engine.cpp", Linked::Static, &[]);
    let cornell = root().join("assets/cornell.gltf");
    for (choice, backend) in BACKENDS {
        let folder = tempfile::tempdir().unwrap();
        if !runs(&program, folder.path(), backend, &[&cornell]) {
            continue;
        }
        let mut engine = Engine::new(choice).unwrap();
        same(folder.path(), "gltf.bin", &reference::gltf(&engine, &cornell));
        same(folder.path(), "submitted.bin", &reference::frames(&mut engine, Way::Submit));
        assert!(image::open(folder.path().join("gltf.png")).unwrap().width() == 64);
        engine.finish();
    }
}

/// Many devices of lightoven's over one queue, in five threads at a time: the validation layers have nothing to say.
#[test]
fn a_queue_that_is_handed_over_often() {
    let text = run(&mut Command::new(compile("queue.c", Linked::Shared, &["-pthread"])));
    println!("{text}");
    assert!(text.contains("5 threads"), "{text}");
}

/// Nothing links Vulkan: all that engines hand over is vkGetInstanceProcAddr.
#[test]
fn nothing_links_vulkan() {
    let library = crate::library::prefix().join("lib/liblightoven.so");
    for program in [library, compile("engine.c", Linked::Shared, &[]), compile("engine.cpp", Linked::Static, &[])] {
        let needed = run(Command::new("readelf").arg("--dynamic").arg(&program));
        assert!(needed.contains("NEEDED") && !needed.contains("libvulkan"), "{}: {needed}", program.display());
    }
}
