//! Queues: of a family that can do the work, and for one thread at a time.

use super::info::Timestamps;
use super::shared::Shared;
use crate::error::{Error, Result};
use ash::vk;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

/// A queue and the family that it was taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawQueue {
    /// The queue.
    pub handle: vk::Queue,
    /// Its family.
    pub family: u32,
}

impl RawQueue {
    /// # Errors
    /// `InvalidSettings` where the queue for compute is this one, of another family.
    pub(super) fn check_family_of(self, compute: Self) -> Result<()> {
        if self.handle != compute.handle || self.family == compute.family {
            return Ok(());
        }
        let [family, other] = [self.family, compute.family];
        Err(Error::settings(format!(
            "the queue for compute is the queue, and its family {other}; allowed is {family}, the queue's, or another queue"
        )))
    }
}

/// A queue, for one thread at a time, whichever [`super::Gpu`] it submits by.
pub(super) struct Queue {
    handle: Arc<Mutex<vk::Queue>>,
    pub(super) family: u32,
    /// How timestamps of the family count.
    pub(super) timestamps: Option<Timestamps>,
}

/// What an engine hands over twice is one queue all the same. By the device too: another's queue may have the same number.
static IN_USE: LazyLock<Shared<(vk::Device, vk::Queue), Mutex<vk::Queue>>> = LazyLock::new(Shared::default);

impl Queue {
    pub(super) fn new(
        raw: RawQueue,
        instance: &ash::Instance,
        physical_device: vk::PhysicalDevice,
        device: vk::Device,
    ) -> Result<Arc<Self>> {
        let timestamps = super::info::timestamps(instance, physical_device, raw.family);
        let handle = IN_USE.get_or_make((device, raw.handle), |_| Ok(Mutex::new(raw.handle)))?;
        Ok(Arc::new(Self { handle, family: raw.family, timestamps }))
    }

    /// The queue, for this thread alone while the guard lives.
    pub(super) fn lock(&self) -> MutexGuard<'_, vk::Queue> {
        self.handle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What a queue is for, and the kinds of work that this takes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Purpose {
    name: &'static str,
    needed: vk::QueueFlags,
    kinds: &'static str,
}

impl Purpose {
    /// Set-up, and what is recorded into the engine's commands. Graphics and compute can do transfers too.
    pub(super) const ALL: Self = Self {
        name: "the queue",
        needed: vk::QueueFlags::from_raw(vk::QueueFlags::GRAPHICS.as_raw() | vk::QueueFlags::COMPUTE.as_raw()),
        kinds: "graphics and compute",
    };
    /// Work of our own within frames.
    pub(super) const COMPUTE: Self =
        Self { name: "the queue for compute", needed: vk::QueueFlags::COMPUTE, kinds: "compute" };

    /// # Errors
    /// `InvalidSettings` where the device has no such family, or one that cannot do the work. Whether the queue is of that
    /// family nobody can tell.
    pub(super) fn check(self, family: u32, families: &[vk::QueueFamilyProperties]) -> Result<()> {
        let fits = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(self.needed);
        if families.get(family as usize).is_some_and(fits) {
            return Ok(());
        }
        let Self { name, kinds, .. } = self;
        let numbered = families.iter().enumerate().filter(|(_, family)| fits(family));
        let allowed = numbered.map(|(index, _)| index.to_string()).collect::<Vec<_>>();
        let allowed = if allowed.is_empty() { "none".to_owned() } else { allowed.join(", ") };
        let count = families.len();
        Err(Error::settings(format!(
            "the family of {name} is {family}; the device has {count}, and allowed are those with {kinds}: {allowed}"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_that_cannot_do_the_work_are_named() {
        let kinds =
            [vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE, vk::QueueFlags::TRANSFER, vk::QueueFlags::COMPUTE];
        let families = kinds.map(|queue_flags| vk::QueueFamilyProperties { queue_flags, ..Default::default() });
        let message = |purpose: Purpose, family| purpose.check(family, &families).map_err(|error| error.to_string());
        assert!(message(Purpose::ALL, 0).is_ok() && message(Purpose::COMPUTE, 0).is_ok());
        assert!(message(Purpose::COMPUTE, 2).is_ok());
        let refused = message(Purpose::ALL, 2).expect_err("has no graphics");
        assert!(
            refused.ends_with("the queue is 2; the device has 3, and allowed are those with graphics and compute: 0")
        );
        let refused = message(Purpose::COMPUTE, 1).expect_err("has no compute");
        assert!(refused.ends_with("for compute is 1; the device has 3, and allowed are those with compute: 0, 2"));
        let refused = Purpose::COMPUTE.check(0, &families[1..2]).expect_err("has no compute").to_string();
        assert!(refused.ends_with("the device has 1, and allowed are those with compute: none"), "{refused}");
        assert!(message(Purpose::ALL, 3).is_err() && message(Purpose::COMPUTE, u32::MAX).is_err());
    }

    #[test]
    fn a_queue_is_of_one_family() {
        use ash::vk::Handle;
        let queue = |handle, family| RawQueue { handle: vk::Queue::from_raw(handle), family };
        assert!(queue(1, 0).check_family_of(queue(1, 0)).is_ok() && queue(1, 0).check_family_of(queue(2, 1)).is_ok());
        let refused = queue(1, 0).check_family_of(queue(1, 2)).expect_err("are two families").to_string();
        assert!(refused.contains("is the queue, and its family 2; allowed is 0"), "{refused}");
    }

    /// Two of one queue wait for each other; those of another queue, or of another device, do not.
    #[test]
    fn a_queue_has_one_lock() {
        use ash::vk::Handle;
        let lock = |device, queue| {
            let key = (vk::Device::from_raw(device), vk::Queue::from_raw(queue));
            IN_USE.get_or_make(key, |_| Ok(Mutex::new(key.1))).expect("is made")
        };
        let [first, again, other, elsewhere] = [lock(1, 1), lock(1, 1), lock(1, 2), lock(2, 1)];
        let _held = first.lock().expect("is free");
        assert!(again.try_lock().is_err() && other.try_lock().is_ok() && elsewhere.try_lock().is_ok());
    }
}
