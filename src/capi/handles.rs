//! Handles: numbers that are never used twice, so that one that was destroyed is told from one that lives.

use super::status::{Failure, Outcome};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One sequence for all kinds: an id of another kind is never found.
static NEXT: AtomicU64 = AtomicU64::new(1);

/// All that live of a kind of handle.
pub(super) struct Registry<T> {
    kind: &'static str,
    entries: Mutex<BTreeMap<u64, Arc<T>>>,
}

impl<T> Registry<T> {
    pub(super) const fn new(kind: &'static str) -> Self {
        Self { kind, entries: Mutex::new(BTreeMap::new()) }
    }

    fn entries(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<T>>> {
        // Nothing between taking and leaving it can panic half way.
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn missing(&self, id: u64) -> Failure {
        let kind = self.kind;
        Failure::argument(match id {
            0 => format!("the {kind} is the null handle"),
            _ => format!("there is no {kind} {id}: it was destroyed, or never made"),
        })
    }

    pub(super) fn insert(&self, value: T) -> u64 {
        let id = NEXT.fetch_add(1, Ordering::Relaxed);
        self.entries().insert(id, Arc::new(value));
        id
    }

    /// What the handle stands for; it is in use while the value returned lives.
    pub(super) fn get(&self, id: u64) -> Outcome<Arc<T>> {
        self.entries().get(&id).cloned().ok_or_else(|| self.missing(id))
    }

    /// Takes out what the handle stands for; nothing for the null handle. `users`: who may still use it.
    pub(super) fn remove(&self, id: u64, users: &str) -> Outcome {
        let removed = {
            let mut entries = self.entries();
            match entries.get(&id) {
                None if id == 0 => return Ok(()),
                None => return Err(self.missing(id)),
                Some(entry) if Arc::strong_count(entry) > 1 => {
                    return Err(Failure::in_use(format!("the {} {id} is in use by {users}", self.kind)));
                }
                Some(_) => entries.remove(&id),
            }
        };
        // Outside the lock: it may take its time.
        drop(removed);
        Ok(())
    }
}
