//! What of a device's objects is alive, by name.

use super::Gpu;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Pipelines, buffers and images that are alive: how many there are of each name. What an engine made is not among them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Objects {
    /// By the shader's file name, or for pipelines that draw by their own.
    pub pipelines: BTreeMap<String, usize>,
    /// By what they hold. Those of acceleration structures are among them.
    pub buffers: BTreeMap<String, usize>,
    /// By what they hold.
    pub images: BTreeMap<String, usize>,
    /// SPIR-V that the pipelines were made from, bytes.
    pub spirv_bytes: u64,
}

impl Objects {
    /// All of all kinds.
    pub fn count(&self) -> usize {
        [&self.pipelines, &self.buffers, &self.images].into_iter().flat_map(BTreeMap::values).sum()
    }

    fn of(&mut self, kind: ObjectKind) -> &mut BTreeMap<String, usize> {
        match kind {
            ObjectKind::Pipeline => &mut self.pipelines,
            ObjectKind::Buffer => &mut self.buffers,
            ObjectKind::Image => &mut self.images,
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) enum ObjectKind {
    Pipeline,
    Buffer,
    Image,
}

/// The count of a device.
#[derive(Default)]
pub(super) struct Ledger(Mutex<Objects>);

impl Ledger {
    fn lock(&self) -> MutexGuard<'_, Objects> {
        // A panic in another thread leaves the counts as they were between two calls.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// An object's entry, which goes with it.
pub(super) struct Counted {
    ledger: Arc<Ledger>,
    kind: ObjectKind,
    name: String,
    spirv_bytes: u64,
}

impl Counted {
    fn new(ledger: &Arc<Ledger>, kind: ObjectKind, name: &str, spirv_bytes: u64) -> Self {
        let name = name.to_owned();
        let mut objects = ledger.lock();
        *objects.of(kind).entry(name.clone()).or_default() += 1;
        objects.spirv_bytes += spirv_bytes;
        drop(objects);
        Self { ledger: Arc::clone(ledger), kind, name, spirv_bytes }
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        let mut objects = self.ledger.lock();
        objects.spirv_bytes -= self.spirv_bytes;
        let names = objects.of(self.kind);
        if let Some(count) = names.get_mut(&self.name) {
            *count -= 1;
            if *count == 0 {
                names.remove(&self.name);
            }
        }
    }
}

impl Gpu {
    /// What lightoven has made on this device by this `Gpu` and its clones, and not yet destroyed: for tests, and to
    /// find what holds memory.
    pub fn objects(&self) -> Objects {
        self.inner.ledger.lock().clone()
    }

    /// To be held by the object.
    pub(super) fn count(&self, kind: ObjectKind, name: &str) -> Counted {
        Counted::new(&self.inner.ledger, kind, name, 0)
    }

    /// To be held by a pipeline of these modules.
    pub(super) fn count_pipeline(&self, name: &str, modules: &[&[u32]]) -> Counted {
        let bytes = modules.iter().map(|words| size_of_val(*words) as u64).sum();
        Counted::new(&self.inner.ledger, ObjectKind::Pipeline, name, bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::{Counted, Ledger, ObjectKind};
    use std::sync::Arc;

    #[test]
    fn names_are_counted_while_they_live() {
        let ledger = Arc::new(Ledger::default());
        let count = |kind, name| Counted::new(&ledger, kind, name, 8);
        let now = || ledger.lock().clone();
        let (first, second) = (count(ObjectKind::Buffer, "nodes"), count(ObjectKind::Buffer, "nodes"));
        let _image = count(ObjectKind::Image, "nodes");
        assert_eq!([now().buffers["nodes"], now().images["nodes"], now().count()], [2, 1, 3]);
        assert_eq!(now().spirv_bytes, 24);
        drop(first);
        assert_eq!(now().buffers["nodes"], 1);
        drop(second);
        assert!(now().buffers.is_empty() && now().pipelines.is_empty());
        assert_eq!((now().count(), now().spirv_bytes), (1, 8));
    }
}
