//! What a frame may be given to do.

use super::frame::TILE;
use std::ops::Range;

/// Part of the cycle. Each has its own cost model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Direct light; items are tiles.
    Direct,
    /// What rays are aimed by; items are parts of its making.
    Importance,
    /// Quanta of rays from every texel; items are tiles.
    Gather,
    /// A map made from the list of texels; items are rows of blocks.
    Publish,
}

/// How many there are.
pub(crate) const STAGES: usize = 4;

/// One dispatch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Work {
    pub(crate) stage: Stage,
    pub(crate) items: Range<u32>,
    /// The same in a whole sweep of gathering; 1 in other stages.
    pub(crate) quanta: u32,
    /// Whether this is the stage's last dispatch.
    pub(crate) ends_stage: bool,
}

/// How much there is to do in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Extent {
    /// Entries of the list of texels.
    pub(crate) texels: u32,
    /// Lights, each a shadow ray of direct light.
    pub(crate) lights: u32,
    /// Rows of blocks that publishing goes through; 0: nothing is published.
    pub(crate) block_rows: u32,
    /// Texels of the map in a row of blocks.
    pub(crate) texels_per_block_row: u32,
    /// Parts that making what rays are aimed by may be cut into; 0: none are.
    pub(crate) importance_parts: u32,
    /// Texels of the map in such a part.
    pub(crate) texels_per_importance_part: u32,
    /// Quanta of every visit, instead of as many as fill a frame.
    pub(crate) fixed_quanta: Option<u32>,
}

impl Extent {
    /// Tiles of the list of texels.
    pub(crate) fn tiles(&self) -> u32 {
        self.texels.div_ceil(TILE)
    }

    pub(super) fn items(&self, stage: Stage) -> u32 {
        match stage {
            Stage::Direct | Stage::Gather => self.tiles(),
            Stage::Importance => self.importance_parts,
            Stage::Publish => self.block_rows,
        }
    }
}

/// What the world asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Needs {
    /// Direct light is out of date.
    pub(crate) direct: bool,
    /// What shines has changed: rays are to be aimed anew in the next sweep that begins.
    pub(crate) importance: bool,
    /// The same for the sweep after the one that is under way.
    pub(crate) importance_after: bool,
    /// A map may be published: a free one exists.
    pub(crate) publish: bool,
}
