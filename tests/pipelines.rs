//! Pipelines are shared between scenes and kept between runs, and objects are counted while they live.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/device.rs"]
mod device;

use device::on_both_back_ends;
use glam::{DAffine3, DVec3};
use lightoven::ErrorKind;
use lightoven::baker::{BakeSettings, Baker, Stop};
use lightoven::gpu::{Gpu, Objects};
use lightoven::headless::{Headless, HeadlessSettings, Validation};
use lightoven::scene::{LightKind, Resolution, Scene};
use lightoven::verify::stage::{Chart, Facing, Stage, level_square};
use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// A floor under a lamp, and perhaps a point light.
fn scene(light: Option<LightKind>) -> Scene {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 5.0));
    let floor = level_square(4.0, 0.0, Facing::Up, Chart::large(0), grey);
    let light_source = level_square(1.0, 3.0, Facing::Down, Chart::large(1), lamp);
    stage.place(&[floor, light_source], DAffine3::IDENTITY);
    if let Some(light) = light {
        stage.light(light);
    }
    stage.build().unwrap()
}

fn point_light() -> LightKind {
    LightKind::Point { position: DVec3::new(1.0, 1.0, 2.0), range: None }
}

fn baked(gpu: &Gpu, scene: &Scene) -> Baker {
    let settings = BakeSettings { resolution: Resolution::Texels(128), ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, scene, &settings).unwrap();
    let stop = Stop { samples: Some(64), ..Stop::default() };
    baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    baker
}

fn all(pipelines: &BTreeMap<String, usize>) -> usize {
    pipelines.values().sum()
}

fn the_same_scene_needs_no_more(gpu: &Gpu) {
    let first = baked(gpu, &scene(None));
    let before = gpu.objects();
    let second = baked(gpu, &scene(None));
    let both = gpu.objects();
    assert_eq!(both.pipelines, before.pipelines);
    let twice = before.buffers.iter().map(|(name, count)| (name.clone(), 2 * count)).collect();
    assert_eq!(both.buffers, twice);
    // What is shared outlives either.
    drop(first);
    assert_eq!(gpu.objects(), before);
    drop(second);
    assert_eq!(gpu.objects(), Objects::default());
}

/// Scenes that differ in analytic lights alone.
fn a_light_changes_what_reads_it(gpu: &Gpu) {
    let dark = baked(gpu, &scene(None));
    let without = gpu.objects().pipelines;
    let lit = baked(gpu, &scene(Some(point_light())));
    let both = gpu.objects().pipelines;
    assert_eq!(without.get("direct.comp"), None);
    assert_eq!(both["direct.comp"], 1);
    for shared in ["bake.comp", "bounce.comp", "dilate.comp"] {
        assert_eq!([without[shared], both[shared]], [1, 1], "{shared}");
    }
    for own in ["resolve.comp", "source.comp"] {
        assert_eq!([without[own], both[own]], [1, 2], "{own}");
    }
    drop(dark);
    let with = gpu.objects().pipelines;
    assert!(all(&with) > all(&without) && all(&with) < all(&both));
    drop(lit);
    assert_eq!(gpu.objects(), Objects::default());
}

/// And what was made before the failure is gone.
fn failures_leave_nothing(gpu: &Gpu) {
    let kept = baked(gpu, &scene(None));
    let before = gpu.objects();
    let side = gpu.info().max_image_side + 1;
    let settings = BakeSettings { resolution: Resolution::Texels(side), ..BakeSettings::default() };
    let error = Baker::new(gpu, &scene(Some(point_light())), &settings).err().unwrap();
    assert!(matches!(error.kind(), ErrorKind::InvalidSettings | ErrorKind::OutOfMemory), "{error}");
    assert_eq!(gpu.objects(), before);
    drop(kept);
    assert_eq!(gpu.objects().count(), 0);
}

/// Names and bytes of the files in a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let Ok(entries) = fs::read_dir(folder) else { return BTreeMap::new() };
    let file = |entry: fs::DirEntry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap());
    entries.map(|entry| file(entry.unwrap())).collect()
}

/// Bakes on a device of its own, whose pipelines are kept in `folder`.
fn run(folder: &Path) {
    let pipeline_folder = Some(folder.to_owned());
    let settings = HeadlessSettings { pipeline_folder, validation: Validation::On, ..HeadlessSettings::default() };
    let headless = Headless::new(&settings).unwrap();
    drop(baked(headless.gpu(), &scene(None)));
    assert_eq!(headless.validation_messages(), Vec::<String>::new());
}

#[test]
fn pipelines_are_kept() {
    let parent = tempfile::tempdir().unwrap();
    // Made where it is not there.
    let folder = parent.path().join("a/b");
    run(&folder);
    let first = files(&folder);
    assert_eq!(first.len(), 1, "{:?}", first.keys());
    let (name, bytes) = first.first_key_value().unwrap();
    assert!(name.ends_with("-software.pipelines") && !bytes.is_empty(), "{name}");
    let path = folder.join(name);
    let written = || fs::metadata(&path).unwrap().modified().unwrap();
    let before = written();
    run(&folder);
    // Drivers may give the same pipelines in another order, but not other ones.
    assert_eq!(files(&folder)[name].len(), bytes.len());
    if files(&folder)[name] == *bytes {
        assert_eq!(written(), before);
    }
    // Whatever stands there, a bake goes on, and puts it right.
    let damaged = [&bytes[..bytes.len() / 2], b"", b"LOVPIPES", &bytes[1..], &vec![0xff; 1 << 20]];
    for content in damaged {
        fs::write(&path, content).unwrap();
        run(&folder);
        assert_eq!(files(&folder)[name].len(), bytes.len());
    }
    assert_eq!(files(&folder).len(), 1);
}

/// A pipe, which nobody writes to, would never end.
#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path());
    let name = files(folder.path()).into_keys().next().unwrap();
    let path = folder.path().join(name);
    fs::remove_file(&path).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    run(folder.path());
    assert!(!fs::metadata(&path).unwrap().is_file(), "the pipe was replaced");
}

/// A bake does not need the folder.
#[test]
fn folders_that_cannot_be_written_are_no_error() {
    let parent = tempfile::tempdir().unwrap();
    let file = parent.path().join("file");
    fs::write(&file, "not a folder").unwrap();
    run(&file);
    run(&file.join("below"));
    assert_eq!(fs::read(&file).unwrap(), b"not a folder");
}

on_both_back_ends!(the_same_scene_needs_no_more, a_light_changes_what_reads_it, failures_leave_nothing);
