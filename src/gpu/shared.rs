//! What is made once, however many use it, and goes with the last of them.

use crate::error::Result;
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Finds what is alive by what it was made from.
pub(super) struct Shared<K, V>(Mutex<HashMap<K, Weak<V>>>);

impl<K, V> Default for Shared<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Eq + Hash, V> Shared<K, V> {
    /// What there is of `key`, or what `make` makes of it. Nothing is locked meanwhile, for a driver may compile for
    /// seconds; of two that make the same at a time the second one's goes at once.
    pub(super) fn get_or_make(&self, key: K, make: impl FnOnce(&K) -> Result<V>) -> Result<Arc<V>> {
        if let Some(found) = find(&self.lock(), &key) {
            return Ok(found);
        }
        let made = Arc::new(make(&key)?);
        let mut known = self.lock();
        if let Some(first) = find(&known, &key) {
            return Ok(first);
        }
        known.retain(|_, value| value.strong_count() > 0);
        known.insert(key, Arc::downgrade(&made));
        Ok(made)
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<K, Weak<V>>> {
        // A panic in another thread leaves the map as it was between two calls.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn find<K: Eq + Hash, V>(known: &HashMap<K, Weak<V>>, key: &K) -> Option<Arc<V>> {
    known.get(key).and_then(Weak::upgrade)
}

#[cfg(test)]
mod tests {
    use super::Shared;
    use crate::error::{Error, ErrorKind};
    use std::sync::Arc;

    #[test]
    fn the_same_is_made_once() {
        let shared = Shared::default();
        let first = shared.get_or_make(1, |key| Ok(key * 10)).expect("is made");
        let again = shared.get_or_make(1, |_| unreachable!("it is there")).expect("is found");
        let other = shared.get_or_make(2, |key| Ok(key * 10)).expect("is made");
        assert!(Arc::ptr_eq(&first, &again) && *first == 10 && *other == 20);
    }

    #[test]
    fn what_nobody_uses_is_forgotten() {
        let shared = Shared::default();
        drop(shared.get_or_make(1, |_| Ok(10)).expect("is made"));
        let anew = shared.get_or_make(1, |_| Ok(11)).expect("is made");
        assert_eq!(*anew, 11);
        drop(anew);
        let _other = shared.get_or_make(2, |_| Ok(20)).expect("is made");
        assert_eq!(shared.lock().len(), 1);
    }

    #[test]
    fn what_cannot_be_made_may_be_tried_again() {
        let shared = Shared::default();
        let failed = shared.get_or_make(1, |_| Err(Error::new(ErrorKind::OutOfMemory, "full")));
        assert!(failed.is_err() && shared.lock().is_empty());
        assert_eq!(*shared.get_or_make(1, |_| Ok(10)).expect("is made"), 10);
    }

    /// What is made by way of another thread in the meantime is kept, and ours goes.
    #[test]
    fn the_first_of_two_stays() {
        let shared = Shared::default();
        let mut first = None;
        let second = shared.get_or_make(1, |key| {
            first = Some(shared.get_or_make(*key, |_| Ok(10))?);
            Ok(11)
        });
        assert_eq!([*first.expect("is made"), *second.expect("is found")], [10, 10]);
    }
}
