//! The frame benchmark, run as a user runs it. How fast anything is depends on the machine and is asserted nowhere.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

fn bench(scene: &str, more: &[&str]) -> Output {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(scene);
    let mut command = Command::new(env!("CARGO_BIN_EXE_frame_bench"));
    command.arg(scene).args(more).env("LIGHTOVEN_VALIDATION", "1").output().expect("the benchmark starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Few frames of a small picture and light map.
const FEW: [&str; 10] = ["--frames", "4", "--warm-up", "3", "--resolution", "64", "--width", "96", "--height", "64"];

fn run_to(folder: &TempDir, scene: &str, mode: &str) -> Value {
    let path = |name: &str| folder.path().join(name).to_str().expect("is UTF-8").to_owned();
    let outputs = [("--report", "r.json"), ("--plot", "p.svg"), ("--csv", "f.csv"), ("--screenshot", "s.png")];
    let outputs: Vec<String> = outputs.iter().flat_map(|(option, name)| [(*option).to_owned(), path(name)]).collect();
    let mut arguments = vec!["--mode", mode, "--budget-ms", "1,4"];
    arguments.extend(FEW);
    arguments.extend(outputs.iter().map(String::as_str));
    let output = bench(scene, &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    assert!(table.contains("overlap") && table.contains("raster only"), "{table}");
    serde_json::from_slice(&fs::read(path("r.json")).expect("was written")).expect("is JSON")
}

#[test]
fn every_output_is_written_in_both_modes() {
    for (scene, mode) in [("cornell.gltf", "record"), ("courtyard.gltf", "submit")] {
        let folder = tempfile::tempdir().expect("has room");
        let report = run_to(&folder, scene, mode);
        assert_eq!(report["mode"], mode);
        assert!(["device", "driver", "backend"].iter().all(|name| report[name].is_string()), "{report}");
        let budgets = report["budgets"].as_array().expect("is a list");
        assert_eq!(budgets.iter().map(|b| b["budget_ms"].as_f64()).collect::<Vec<_>>(), [Some(1.0), Some(4.0)]);
        for budget in budgets {
            let frames = budget["frames"].as_u64().expect("is a count");
            assert!(0 < frames && frames <= 8, "{budget}");
            for times in ["bake_ms", "frame_ms", "raster_only_ms"] {
                let at = |share| budget[times][share].as_f64().expect("is a number");
                assert!(at("p50") <= at("p95") && at("p95") <= at("p99"), "{budget}");
            }
            let numbers = ["use", "overshoot_p95", "rays_per_frame", "samples_per_texel_per_frame"];
            assert!(numbers.iter().all(|name| budget[name].is_number()), "{budget}");
        }
        let names = ["efficiency", "low", "high", "raster_slowdown"];
        // On a busy machine frames this small may have no time for a ray, and there is nothing to overlap.
        let overlap = report.get("overlap").expect("is there");
        assert!(overlap.is_null() || names.iter().all(|name| overlap[name].is_number()), "{report}");

        let read = |name: &str| fs::read(folder.path().join(name)).expect("was written");
        let rows = text(&read("f.csv")).lines().count();
        assert_eq!(rows, 1 + 3 * (3 + 3 * 4), "a head, and for two budgets and the overlap warm-up and three cases");
        assert!(text(&read("p.svg")).ends_with("</svg>\n"));
        let picture = image::load_from_memory(&read("s.png")).expect("is an image").to_luma8();
        assert_eq!(picture.dimensions(), (96, 64));
        let (least, most) = picture.pixels().fold((255, 0), |(l, m), p| (p.0[0].min(l), p.0[0].max(m)));
        assert!(least < 100 && most > 150, "the picture is from {least} to {most}");
    }
}

#[test]
fn bad_values_are_named_with_what_is_allowed() {
    for (option, value, allowed) in [
        ("--frames", "0", "1 to 1000000"),
        ("--warm-up", "-1", "0 to 1000000"),
        ("--budget-ms", "2,x", "1 to 16 different numbers over 0"),
        ("--resolution", "16385", "1 to 16384"),
        ("--width", "0", "1 to 4096"),
        ("--mode", "both", "record, submit"),
        ("--backend", "cpu", "auto, software, ray-query"),
        ("--device", "no such device", "there are:"),
    ] {
        let output = bench("cornell.gltf", &[option, value]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let named = option.trim_start_matches('-');
        assert!(said.contains(value) && said.contains(allowed) && said.contains(named), "{said}");
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_any_work() {
    for (option, value, says) in [
        ("--report", "/no/such/folder/r.json", "there is no folder '/no/such/folder'"),
        ("--screenshot", env!("CARGO_MANIFEST_DIR"), "is not a file"),
    ] {
        let output = bench("cornell.gltf", &[option, value]);
        assert_eq!(output.status.code(), Some(1));
        let said = text(&output.stderr);
        assert!(said.contains(value) && said.contains(says), "{said}");
    }
    let both = bench("cornell.gltf", &["--csv", "same", "--plot", "same"]);
    assert_eq!(both.status.code(), Some(2), "{}", text(&both.stderr));
}

#[cfg(unix)]
#[test]
fn an_interrupt_writes_what_there_is() {
    let folder = tempfile::tempdir().expect("has room");
    let (report, rows) = (folder.path().join("r.json"), folder.path().join("f.csv"));
    // A slow machine may not have measured anything at first, and then writes nothing.
    for wait_s in [4, 20, 100] {
        interrupt_after(wait_s, &report, &rows);
        if report.exists() {
            break;
        }
    }
    let report: Value = serde_json::from_slice(&fs::read(report).expect("was written")).expect("is JSON");
    assert_eq!(report["interrupted"], true);
    assert!(fs::read_to_string(rows).expect("was written").lines().count() > 2);
}

#[cfg(unix)]
fn interrupt_after(wait_s: u64, report: &Path, rows: &Path) {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/cornell.gltf");
    let mut command = Command::new(env!("CARGO_BIN_EXE_frame_bench"));
    command.arg(scene).args([
        "--frames",
        "1000000",
        "--warm-up",
        "1",
        "--resolution",
        "64",
        "--width",
        "64",
        "--quiet",
    ]);
    command.arg("--report").arg(report).arg("--csv").arg(rows);
    let mut child = command.spawn().expect("the benchmark starts");
    std::thread::sleep(std::time::Duration::from_secs(wait_s));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill is there");
    assert!(killed.success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
}
