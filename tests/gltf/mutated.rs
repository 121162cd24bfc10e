//! Valid documents changed where it hurts: values, kinds, counts, offsets, indices and keys, and the binary.
//!
//! Whatever becomes of them is refused with a message, soon, or a scene that can be laid out and traced.

use crate::gltf_builder::Builder;
use crate::mutations::specimen;
use crate::{Folder, square};
use lightoven::bvh::{Bvh, Ray};
use lightoven::scene::{Atlas, Resolution, Scene};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use serde_json::{Value, json};
use std::cell::Cell;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

const CASES: u32 = 1500;
/// A read takes about a millisecond; the most that a busy machine may make of it.
const SOON: Duration = Duration::from_secs(10);

/// One change of a document; places and choices are taken modulo how many there are.
#[derive(Debug, Clone)]
enum Change {
    /// The value there becomes one that is seldom expected.
    Replace {
        place: usize,
        value: Value,
    },
    /// The number there becomes a neighbour, its double or its negative.
    Nudge {
        place: usize,
        how: usize,
    },
    Delete {
        place: usize,
    },
    /// A list's element once more, behind itself; an object's value under its neighbour's key.
    Repeat {
        place: usize,
    },
    /// A value from elsewhere.
    Copy {
        from: usize,
        to: usize,
    },
    /// A key of the outermost object twice.
    SecondKey {
        key: usize,
        value: Value,
    },
    CutBinary {
        at: usize,
    },
    FlipBit {
        bit: usize,
    },
    /// A number or an index in the binary.
    Word {
        at: usize,
        bits: u32,
    },
    /// The finished file ends early.
    CutFile {
        at: usize,
    },
}

/// Values at which indices, counts, offsets, factors and names break.
fn hostile() -> Vec<Value> {
    let deep = (0..120).fold(json!(0), |inside, _| json!([inside]));
    let mut values: Vec<Value> =
        [0, 1, 2, 3, 4, 12, 255, 1 << 16, 1 << 24, 1 << 31, (1 << 32) - 1, 1 << 53, u64::MAX - 3, u64::MAX]
            .map(|number| json!(number))
            .to_vec();
    values.extend([-1.0, 0.5, 1e-30, 1e20, 3.5e38, -1e38, 1e300].map(|number| json!(number)));
    values.extend([-1, i64::MIN].map(|number| json!(number)));
    values.extend([json!(null), json!(true), json!([]), json!({}), json!([0]), json!([0, 0]), deep]);
    let names =
        ["", "x", "SCALAR", "VEC2", "VEC3", "MAT4", "MASK", "POSITION", "spot", "image/png", "\u{0}", "\u{1f525}"];
    values.extend(names.map(|name| json!(name)));
    let uris = ["..", "/dev/zero", "no/such", "https://a/b", "data:", "data:;base64,", "data:;base64,!", "%ff", "%00"];
    values.extend(uris.map(|uri| json!(uri)));
    values
}

fn change() -> impl Strategy<Value = Change> {
    let value = || prop::sample::select(hostile());
    let words =
        [0, 1, u32::MAX, 0x7f80_0000, 0xff80_0000, 0x7fc0_0000, 0x7f7f_ffff, 0xff7f_ffff, 0x0000_0001, 0x8000_0000];
    let any = any::<usize>;
    prop_oneof![
        6 => (any(), value()).prop_map(|(place, value)| Change::Replace { place, value }),
        3 => (any(), 0_usize..4).prop_map(|(place, how)| Change::Nudge { place, how }),
        3 => any().prop_map(|place| Change::Delete { place }),
        2 => any().prop_map(|place| Change::Repeat { place }),
        3 => (any(), any()).prop_map(|(from, to)| Change::Copy { from, to }),
        1 => (any(), value()).prop_map(|(key, value)| Change::SecondKey { key, value }),
        1 => any().prop_map(|at| Change::CutBinary { at }),
        1 => any().prop_map(|bit| Change::FlipBit { bit }),
        3 => (any(), prop::sample::select(words.to_vec())).prop_map(|(at, bits)| Change::Word { at, bits }),
        1 => any().prop_map(|at| Change::CutFile { at }),
    ]
}

/// A document, its binary, and what is done to its bytes in the end.
struct Document {
    root: Value,
    binary: Vec<u8>,
    second_keys: Vec<(String, Value)>,
    cut: Option<usize>,
}

/// The pointers of all values but the outermost.
fn places(value: &Value, above: &str, found: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Object(map) => {
            map.iter().map(|(key, child)| (key.replace('~', "~0").replace('/', "~1"), child)).collect()
        }
        Value::Array(list) => list.iter().enumerate().map(|(index, child)| (index.to_string(), child)).collect(),
        _ => Vec::new(),
    };
    for (key, child) in children {
        let pointer = format!("{above}/{key}");
        places(child, &pointer, found);
        found.push(pointer);
    }
}

impl Document {
    fn of(Builder { root, binary }: Builder) -> Self {
        Self { root, binary, second_keys: Vec::new(), cut: None }
    }

    fn apply(&mut self, change: &Change) {
        let mut pointers = Vec::new();
        places(&self.root, "", &mut pointers);
        if pointers.is_empty() {
            return;
        }
        let pointer = |place: usize| pointers[place % pointers.len()].as_str();
        match change {
            Change::Replace { place, value } => self.put(pointer(*place), value.clone()),
            Change::Nudge { place, how } => {
                let numbers: Vec<&String> = pointers.iter().filter(|p| self.at(p).is_number()).collect();
                let Some(pointer) = numbers.get(place % numbers.len().max(1)) else { return };
                let old = self.at(pointer).clone();
                let new = match (old.as_u64(), old.as_f64().unwrap_or_default()) {
                    (Some(n), _) => json!([n.wrapping_add(1), n.wrapping_sub(1), n.wrapping_mul(2), n ^ 1 << 31][*how]),
                    (None, x) => json!([x + 1.0, x - 1.0, 2.0 * x, -x][*how]),
                };
                self.put(pointer, new);
            }
            Change::Delete { place } => self.with_parent(pointer(*place), |parent, key| match parent {
                Value::Object(map) => drop(map.remove(key)),
                Value::Array(list) => drop(key.parse().map(|index: usize| list.remove(index))),
                _ => {}
            }),
            Change::Repeat { place } => self.with_parent(pointer(*place), |parent, key| match parent {
                Value::Object(map) => {
                    let next = map.keys().skip_while(|other| *other != key).nth(1).cloned();
                    let value = map[key].clone();
                    map.insert(next.unwrap_or_else(|| format!("{key}2")), value);
                }
                Value::Array(list) => {
                    let Ok(index) = key.parse::<usize>() else { return };
                    list.insert(index, list[index].clone());
                }
                _ => {}
            }),
            Change::Copy { from, to } => self.put(pointer(*to), self.at(pointer(*from)).clone()),
            Change::SecondKey { key, value } => {
                let keys =
                    self.root.as_object().map(|root| root.keys().cloned().collect::<Vec<_>>()).unwrap_or_default();
                let name = keys.get(key % keys.len().max(1)).cloned();
                self.second_keys.extend(name.map(|name| (name, value.clone())));
            }
            Change::CutBinary { at } => self.binary.truncate(at % self.binary.len().max(1)),
            Change::FlipBit { bit } => {
                let byte = bit / 8 % self.binary.len().max(1);
                self.binary.get_mut(byte).into_iter().for_each(|byte| *byte ^= 1 << (bit % 8));
            }
            Change::Word { at, bits } => {
                let word = at % (self.binary.len() / 4).max(1) * 4;
                self.binary
                    .get_mut(word..word + 4)
                    .into_iter()
                    .for_each(|word| word.copy_from_slice(&bits.to_le_bytes()));
            }
            Change::CutFile { at } => self.cut = Some(*at),
        }
    }

    fn at(&self, pointer: &str) -> &Value {
        self.root.pointer(pointer).unwrap_or(&Value::Null)
    }

    fn put(&mut self, pointer: &str, value: Value) {
        self.root.pointer_mut(pointer).into_iter().for_each(|place| *place = value.clone());
    }

    fn with_parent(&mut self, pointer: &str, change: impl FnOnce(&mut Value, &str)) {
        let Some((parent, key)) = pointer.rsplit_once('/') else { return };
        let key = key.replace("~1", "/").replace("~0", "~");
        let Some(parent) = self.root.pointer_mut(parent) else { return };
        change(parent, &key);
    }

    /// The whole file; `as_glb`: with the binary in a chunk, else without it.
    fn bytes(&self, as_glb: bool) -> Vec<u8> {
        let mut text = self.root.to_string();
        for (key, value) in &self.second_keys {
            text.insert_str(1, &format!("{}:{value},", json!(key)));
        }
        let mut bytes = text.into_bytes();
        if as_glb {
            bytes = crate::container(bytes, &self.binary);
        }
        if let Some(at) = self.cut {
            bytes.truncate(at % bytes.len());
        }
        bytes
    }
}

/// A `.glb`'s worth of a document that has its buffer as a data URI.
fn asset(name: &str) -> Builder {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name);
    let root: Value = serde_json::from_slice(&fs::read(path).expect("is there")).expect("is JSON");
    Builder { root, binary: Vec::new() }
}

/// The assets' textures, where the documents look for them.
fn with_textures(folder: Folder) -> Folder {
    ["courtyard_sign.png", "courtyard_tiles.png"].into_iter().fold(folder, |folder, name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name);
        folder.with(name, fs::read(path).expect("is there"))
    })
}

/// What was accepted is sound, and can be used.
fn use_scene(scene: &Scene) {
    for mesh in scene.meshes() {
        assert!(mesh.positions().iter().flatten().all(|corner| corner.is_finite()));
        assert!(mesh.normals().iter().flatten().all(|normal| normal.is_normalized()));
        assert!(mesh.materials().iter().all(|material| (*material as usize) < scene.materials().len()));
    }
    assert!(scene.instances().iter().all(|i| i.mesh < scene.meshes().len() && i.transform.is_finite()));
    if scene.triangle_count() > 4000 {
        return;
    }
    let Ok(atlas) = Atlas::new(scene, Resolution::Texels(32)) else { return };
    let Ok(bvh) = Bvh::build(scene, &atlas) else { return };
    let Some((lo, hi)) = scene.bounds() else { return };
    let [origin, target] = [lo, hi].map(|corner| (corner - bvh.centre).as_vec3());
    let ray = Ray { origin, t_min: 0.0, direction: (target - origin).normalize_or(glam::Vec3::Y), t_max: 1e30 };
    let hit = bvh.trace_closest(&ray, None);
    assert!(hit.is_none_or(|hit| hit.t.is_finite()));
    assert_eq!(hit.is_some(), bvh.trace_occluded(&ray, None));
}

/// Changes documents in `CASES` ways, the same in every run; how many of them were still read.
fn change_and_read(name: &str, as_glb: bool, original: impl Fn() -> Builder) {
    let settings = ProptestConfig {
        cases: CASES,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(31),
        ..ProptestConfig::default()
    };
    let folder = with_textures(Folder::new());
    let accepted = Cell::new(0);
    let read = |changes: &[Change]| {
        let mut document = Document::of(original());
        changes.iter().for_each(|change| document.apply(change));
        folder.put(name, document.bytes(as_glb));
        let start = Instant::now();
        let result = folder.read(name);
        let took = start.elapsed();
        assert!(took < SOON, "took {took:?}");
        match result {
            Ok(scene) => {
                accepted.set(accepted.get() + 1);
                use_scene(&scene);
            }
            Err(error) => assert!(error.to_string().len() > 8, "'{error}' says nothing"),
        }
    };
    read(&[]);
    assert_eq!(accepted.get(), 1, "the document is invalid before it is changed");
    let changes = prop::collection::vec(change(), 1..5);
    if let Err(failure) = TestRunner::new(settings).run(&changes, |changes| {
        read(&changes);
        Ok(())
    }) {
        panic!("{failure}");
    }
    let accepted = accepted.get();
    assert!(accepted > CASES / 50 && accepted < CASES, "{accepted} of {CASES} were read");
}

#[test]
fn a_document_of_everything() {
    change_and_read("everything.glb", true, || {
        let mut builder = specimen();
        builder.root["buffers"] = json!([{ "byteLength": builder.binary.len() }]);
        builder
    });
}

#[test]
fn a_square() {
    change_and_read("square.gltf", false, || {
        let embedded = square().embedded();
        Builder { root: serde_json::from_str(&embedded).expect("is JSON"), binary: Vec::new() }
    });
}

#[test]
fn the_furnace() {
    change_and_read("furnace.gltf", false, || asset("furnace.gltf"));
}

#[test]
fn the_cornell_box() {
    change_and_read("cornell.gltf", false, || asset("cornell.gltf"));
}

#[test]
fn the_courtyard() {
    change_and_read("courtyard.gltf", false, || asset("courtyard.gltf"));
}
