//! `lightoven verify` and `lightoven study`: what a run prints, reports and refuses. Whether the cases pass is told by
//! tests/verify.rs, which runs the same list.

use crate::support::{Folder, assert_says, json, number, run};

#[test]
fn cases_are_printed_and_reported() {
    let folder = Folder::new();
    let found = run(["verify", "--only", "albedo .5", "--only", "Closed Form 8", "--report", &folder.text("r.json")]);
    assert_eq!(found.code, Some(0), "{found:?}");
    let says = ["closed form 1, furnace of albedo .5: pass", "lowest irradiance", "closed form 8", "0 failed"];
    assert_says(&found.stdout, &says);
    let report = json(&folder.path("r.json"));
    let cases = report["cases"].as_array().expect("is a list");
    assert!(cases.len() >= 2 && cases.iter().all(|case| case["outcome"] == "pass"), "{report}");
    let rows = cases[0]["rows"].as_array().expect("is a list");
    assert!(rows.iter().all(|row| row["passes"] == true && number(&row["measured"]) > 0.0), "{report}");
    assert!(number(&report["seconds"]) > 0.0 && report["device"].is_string(), "{report}");
}

#[test]
fn bad_usage_is_named_with_what_is_allowed() {
    let found = run(["verify", "--only", "perpetual motion"]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert_says(&found.stderr, &["'perpetual motion'", "closed form 4 parallel unit squares"]);
    let found = run(["verify", "--backend", "magic"]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert_says(&found.stderr, &["'magic'", "ray-query"]);
    let found = run(["study", "colour"]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert_says(&found.stderr, &["'colour'", "stiffness", "precision"]);
    let found = run(["study", "precision", "--plot", "p.svg"]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert_says(&found.stderr, &["--plot", "stiffness"]);
}

#[test]
fn a_study_prints_and_reports_its_tables() {
    let folder = Folder::new();
    let found = run(["study", "precision", "--report", &folder.text("r.json")]);
    assert_eq!(found.code, Some(0), "{found:?}");
    assert_says(&found.stdout, &["scale", "offset", "radiance", "frames/s"]);
    let report = json(&folder.path("r.json"));
    assert_eq!(report["study"], "precision");
    for name in ["scale", "offset", "radiance"] {
        let rows = report[name].as_array().expect("is a list");
        assert!(rows.len() > 5 && rows.iter().all(|row| number(&row["rms"]) < 1e-3), "{report}");
    }
    let decays = report["decay"].as_array().expect("is a list");
    let relative = |row: &serde_json::Value| (number(&row["left"]) - number(&row["expected"])).abs();
    assert!(decays.len() == 25 && decays.iter().all(|row| relative(row) < 1e-4), "{report}");
}
