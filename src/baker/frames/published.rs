//! Which of the light maps the engine sees, and which may be written.

use super::report::FrameId;

/// A ring of light maps. Pure: frames go in, places in the ring come out.
#[derive(Debug, Clone)]
pub(super) struct Published {
    /// `[light map]`: the frame whose completion makes it free; `None`: free.
    held_until: Vec<Option<FrameId>>,
    current: Shown,
    writing: Option<usize>,
    /// Written by a frame that is not complete yet: the map, its sweeps, the frame.
    pending: Option<(usize, u64, FrameId)>,
}

/// A finished light map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::baker) struct Shown {
    /// Its place in the ring.
    pub(in crate::baker) map: usize,
    /// How many were finished up to this one.
    pub(in crate::baker) generation: u64,
    /// Sweeps over all texels that it holds.
    pub(in crate::baker) sweeps: u64,
}

impl Published {
    pub(super) fn new(maps: usize) -> Self {
        Self { held_until: vec![None; maps], current: Shown::default(), writing: None, pending: None }
    }

    /// The newest finished map.
    pub(super) fn current(&self) -> Shown {
        self.current
    }

    /// The map to write, if one is free.
    pub(super) fn begin(&mut self, completed: FrameId) -> Option<usize> {
        if self.writing.is_none() && self.pending.is_none() {
            let is_free =
                |&map: &usize| map != self.current.map && self.held_until[map].is_none_or(|frame| frame <= completed);
            self.writing = (0..self.held_until.len()).find(is_free);
        }
        self.writing
    }

    /// The map that is being written was finished in `frame`. `at_once`: what the engine records from now on may use it;
    /// else it may once the frame is complete.
    pub(super) fn finish(&mut self, frame: FrameId, sweeps: u64, at_once: bool) {
        let Some(map) = self.writing.take() else { return };
        if at_once {
            self.replace(map, sweeps, frame);
        } else {
            self.pending = Some((map, sweeps, frame));
        }
    }

    /// `latest`: the last frame that was recorded.
    pub(super) fn completed(&mut self, completed: FrameId, latest: FrameId) {
        if let Some((map, sweeps, _)) = self.pending.filter(|(_, _, frame)| *frame <= completed) {
            self.pending = None;
            self.replace(map, sweeps, latest);
        }
    }

    /// The old map may be in use by the frame that the engine is making, which is the one after `latest`.
    fn replace(&mut self, map: usize, sweeps: u64, latest: FrameId) {
        self.held_until[self.current.map] = Some(FrameId(latest.0 + 1));
        self.held_until[map] = None;
        self.current = Shown { map, generation: self.current.generation + 1, sweeps };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_in_use_is_not_written() {
        let mut published = Published::new(3);
        assert_eq!(published.begin(FrameId(0)), Some(1));
        published.finish(FrameId(5), 1, true);
        assert_eq!(published.current(), Shown { map: 1, generation: 1, sweeps: 1 });
        // Map 0 may be in use by frame 6; 2 never was.
        assert_eq!(published.begin(FrameId(5)), Some(2));
        published.finish(FrameId(6), 2, true);
        assert_eq!(published.current(), Shown { map: 2, generation: 2, sweeps: 2 });
        assert_eq!(published.begin(FrameId(5)), None);
        assert_eq!(published.begin(FrameId(6)), Some(0));
    }

    #[test]
    fn what_is_submitted_appears_once_it_is_complete() {
        let mut published = Published::new(3);
        assert_eq!(published.begin(FrameId(0)), Some(1));
        published.finish(FrameId(1), 1, false);
        assert_eq!((published.current(), published.begin(FrameId(0))), (Shown::default(), None));
        published.completed(FrameId(1), FrameId(3));
        assert_eq!(published.current(), Shown { map: 1, generation: 1, sweeps: 1 });
        assert_eq!(published.begin(FrameId(3)), Some(2));
    }
}
