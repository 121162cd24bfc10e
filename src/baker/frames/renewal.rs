//! Frames that go on with another scene.

use super::{FrameSettings, Frames, Tile};
use crate::baker::Core;
use crate::error::{Error, Result};

impl Frames {
    pub(in crate::baker) fn settings(&self) -> FrameSettings {
        self.settings
    }

    /// `InvalidSettings` while a frame is under way.
    pub(in crate::baker) fn check_at_rest(&self) -> Result<()> {
        match self.flight.under_way() {
            None => Ok(()),
            Some(frame) => Err(Error::settings(format!(
                "frame {} is under way; allowed is another scene once all frames are reported complete",
                frame.0
            ))),
        }
    }

    /// Takes passes, world and schedule of `new`, which was made of `after`, and goes on: frames, clocks and what tiles hold
    /// stay.
    pub(in crate::baker) fn renew(&mut self, before: &Core, new: Self, after: &Core) {
        let Self { passes, mut aiming, mut world, settling, scheduler, direct_due, used, tiles, .. } = new;
        let is_same_list = before.texels.is_like(&after.texels);
        if !is_same_list || self.tiles.len() != tiles.len() {
            // Which tile a texel is in may be another: none holds less than this.
            let oldest = self.tiles.iter().copied().min_by(|one, other| one.visited_s.total_cmp(&other.visited_s));
            self.tiles = vec![oldest.unwrap_or_else(Tile::default); tiles.len()];
        }
        world.follow(&self.world, before, after);
        self.settling = settling.after(&self.settling);
        aiming.changed(self.sweeps, true);
        // Gathered anew, over what was kept: it may have been half done.
        self.direct_due = direct_due;
        (self.passes, self.aiming, self.world, self.scheduler, self.used) = (passes, aiming, world, scheduler, used);
    }
}
