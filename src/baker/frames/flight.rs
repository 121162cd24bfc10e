//! Frames under way: what each was given to do, until it is reported complete.

use super::report::FrameId;
use crate::gpu::MARKS;
use crate::schedule::{STAGES, Work};
use std::time::Instant;

/// A frame under way.
#[derive(Debug)]
pub(super) struct Row {
    /// `None`: free.
    pub(super) frame: Option<FrameId>,
    pub(super) works: Vec<Work>,
    /// `[stage]`: its pipeline had not run before.
    pub(super) first_use: [bool; STAGES],
    /// Something was written before the works.
    pub(super) updated: bool,
    pub(super) recorded_at: Instant,
}

/// As many rows as frames may be under way.
#[derive(Debug)]
pub(super) struct Flight {
    rows: Vec<Row>,
    /// The last frame that was begun.
    pub(super) latest: FrameId,
    /// The last frame that was reported complete.
    pub(super) completed: FrameId,
}

impl Flight {
    pub(super) fn new(rows: u32) -> Self {
        let row = |_| Row {
            frame: None,
            works: Vec::with_capacity(MARKS),
            first_use: [false; STAGES],
            updated: false,
            recorded_at: Instant::now(),
        };
        Self { rows: (0..rows).map(row).collect(), latest: FrameId::default(), completed: FrameId::default() }
    }

    /// The next frame, and a row for it if there is one.
    pub(super) fn begin(&mut self) -> (FrameId, Option<usize>) {
        self.latest.0 += 1;
        (self.latest, self.rows.iter().position(|row| row.frame.is_none()))
    }

    /// The first frame that was not reported complete yet.
    pub(super) fn under_way(&self) -> Option<FrameId> {
        self.rows.iter().filter_map(|row| row.frame).min()
    }

    pub(super) fn row(&mut self, row: usize) -> &mut Row {
        &mut self.rows[row]
    }

    /// The oldest row that `completed` sets free.
    pub(super) fn next_done(&self) -> Option<usize> {
        let done = |row: &Row| row.frame.filter(|frame| *frame <= self.completed);
        let rows = self.rows.iter().enumerate().filter_map(|(index, row)| Some((done(row)?, index)));
        rows.min().map(|(_, index)| index)
    }
}
