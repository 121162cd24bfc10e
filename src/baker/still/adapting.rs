//! Lets texels stop that have converged, where a bake ends at an error.

use crate::adaptive::{Field, allocate};
use crate::baker::{Core, ErrorEstimate};
use crate::error::Result;
use crate::features::Features;
use crate::pass::ResolveSums;
use crate::schedule::{GROUP, Unit};

/// Which texels take rays. Made only with [`ErrorEstimate::Adaptive`]; else all do.
pub(super) struct Adapting {
    /// `[group][field]`
    texels: Vec<[u32; 2]>,
    quanta: Vec<[u32; 2]>,
    active: Vec<[bool; 2]>,
    /// The error at which the bake ends; none: nothing is decided.
    target: Option<f32>,
}

/// Quanta of a texel before anything is decided: two in each half buffer.
const PILOT_QUANTA: u32 = 4;

impl Adapting {
    pub(super) fn new(core: &mut Core) -> Result<Option<Self>> {
        if core.settings.error != ErrorEstimate::Adaptive || !core.features.contains(Features::GATHERING) {
            return Ok(None);
        }
        let texels = core.texels.fields.clone();
        let (quanta, active) = (vec![[0; 2]; texels.len()], vec![[true; 2]; texels.len()]);
        let adapting = Self { texels, quanta, active, target: None };
        adapting.upload(core)?;
        Ok(Some(adapting))
    }

    /// Whether the target is another one: it holds from the next decision on.
    pub(super) fn aim_for(&mut self, target: Option<f32>) -> bool {
        std::mem::replace(&mut self.target, target) != target
    }

    /// All that take rays have got so many quanta. Returns how many a texel has in the mean, and at most.
    pub(super) fn add(&mut self, quanta: u32) -> (f64, u32) {
        for (group, active) in self.quanta.iter_mut().zip(&self.active) {
            (0..2).filter(|field| active[*field]).for_each(|field| group[field] += quanta);
        }
        let fields = || self.texels.iter().flatten().zip(self.quanta.iter().flatten());
        let sum: f64 = fields().map(|(texels, quanta)| f64::from(*texels) * f64::from(*quanta)).sum();
        let texels: f64 = fields().map(|(texels, _)| f64::from(*texels)).sum();
        (sum / texels.max(1.0), self.quanta.iter().flatten().copied().max().unwrap_or(0))
    }

    /// Quanta, of all texels together, that a unit of work really gathers.
    pub(super) fn quanta_of(&self, unit: &Unit) -> u64 {
        let groups = (unit.texels.start / GROUP) as usize..unit.texels.end.div_ceil(GROUP) as usize;
        let of_group = |group: usize| {
            (0..2).filter(move |field| self.active[group][*field]).map(move |field| self.texels[group][field])
        };
        let texels: u64 = groups.flat_map(of_group).map(u64::from).sum();
        texels * u64::from(unit.quanta.end - unit.quanta.start)
    }

    /// By the errors that are now known.
    pub(super) fn decide(&mut self, core: &mut Core, sums: &ResolveSums) -> Result<()> {
        let Some(target) = self.target else {
            self.active.fill([true; 2]);
            return self.upload(core);
        };
        if self.quanta.iter().flatten().all(|quanta| *quanta < PILOT_QUANTA) {
            return Ok(());
        }
        let field = |group: usize, field: usize| Field {
            texels: self.texels[group][field],
            error: sums.fields[group][field],
            quanta: self.quanta[group][field],
        };
        let groups: Vec<[Field; 2]> = (0..self.texels.len()).map(|group| [0, 1].map(|of| field(group, of))).collect();
        self.active = allocate(&groups, f64::from(target));
        self.upload(core)
    }

    fn upload(&self, core: &mut Core) -> Result<()> {
        let bits: Vec<u32> = self.active.iter().map(|[one, other]| u32::from(*one) | u32::from(*other) << 1).collect();
        let buffer = &core.maps.activity;
        core.commands.run(|recorder| {
            recorder.update_buffer(buffer, 0, &bits);
            Ok(())
        })?;
        Ok(())
    }
}
