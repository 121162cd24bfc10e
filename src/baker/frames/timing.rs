//! How long frames took, and what is learned from it.

use super::report::{FrameId, FrameTiming, MeasuredBy};
use super::settings::{Learning, Timing};
use super::{Frames, MARKS};
use crate::error::{Error, Result};
use crate::gpu::Recorder;
use crate::schedule::STAGES;
use std::time::{Duration, Instant};

/// Spans of time that a frame's dispatches have, one each; in a frame of more, by a budget of some .2 s, the last span is
/// that of all the rest.
pub(super) const TIMED: usize = MARKS - 2;

/// Share of a new measurement in what writing changes is expected to take.
const UPDATE_SHARE: f64 = 0.2;

impl Frames {
    pub(super) fn begin_timing(&self, recorder: &Recorder<'_>, row: usize) {
        if let Some(timer) = &self.timer {
            timer.reset(recorder, row as u32);
            timer.mark(recorder, row as u32, 0);
        }
    }

    /// `mark`: 1 after what changed was written, then one for each dispatch.
    pub(super) fn mark(&self, recorder: &Recorder<'_>, row: usize, mark: usize) {
        if let Some(timer) = &self.timer {
            timer.mark(recorder, row as u32, mark);
        }
    }

    /// The device has finished all frames up to this one.
    pub(in crate::baker) fn complete(&mut self, frame: FrameId) -> Result<Option<FrameTiming>> {
        let latest = self.flight.latest;
        if frame > latest {
            let (frame, latest) = (frame.0, latest.0);
            return Err(Error::settings(format!(
                "frame {frame} is reported complete; allowed are frames up to {latest}, the last one begun"
            )));
        }
        self.flight.completed = self.flight.completed.max(frame);
        let mut timing = None;
        let now = Instant::now();
        while let Some(row) = self.flight.next_done() {
            timing = Some(self.learn(row, now)).filter(|timing| timing.frame == frame);
        }
        self.reported_at = Some(now);
        self.published.completed(self.flight.completed, latest);
        Ok(timing)
    }

    /// Feeds a finished frame's times to the cost model, and sets its row free.
    fn learn(&mut self, index: usize, now: Instant) -> FrameTiming {
        let mut spans_s = [0.0; MARKS - 1];
        let row = self.flight.row(index);
        let frame = row.frame.take().unwrap_or_default();
        let works = std::mem::take(&mut row.works);
        let (first_use, updated, recorded_at) = (row.first_use, row.updated, row.recorded_at);
        let count = works.len().min(TIMED);
        let by_timestamps = self.settings.timing == Timing::Timestamps
            && self.timer.as_ref().is_some_and(|timer| timer.read(index as u32, &mut spans_s[..=count]));
        let learns = self.learning == Learning::On;
        let bake_s = if by_timestamps && !learns {
            spans_s[..=count].iter().sum()
        } else if by_timestamps {
            let alone = if works.len() > TIMED { TIMED - 1 } else { works.len() };
            for (work, span_s) in works[..alone].iter().zip(&spans_s[1..]) {
                self.scheduler.measured(work, *span_s, first_use[work.stage as usize]);
            }
            self.scheduler.measured_frame(&works[alone..], spans_s[TIMED]);
            if updated {
                let weight = if self.update_s == 0.0 { 1.0 } else { UPDATE_SHARE };
                self.update_s += weight * (spans_s[0] - self.update_s);
            }
            spans_s[..=count].iter().sum()
        } else {
            // What came before the last report was another frame's time, where frames overlap.
            let from = self.reported_at.map_or(recorded_at, |reported_at| reported_at.max(recorded_at));
            let elapsed_s = now.saturating_duration_since(from).as_secs_f64();
            if first_use == [false; STAGES] && !works.is_empty() && learns {
                self.scheduler.measured_frame(&works, elapsed_s);
            }
            elapsed_s
        };
        self.flight.row(index).works = works;
        FrameTiming {
            frame,
            bake: Duration::from_secs_f64(bake_s),
            measured_by: if by_timestamps { MeasuredBy::Timestamps } else { MeasuredBy::Host },
            first_use: first_use != [false; STAGES],
        }
    }
}
