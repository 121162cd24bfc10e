//! Which bits of its specialisation constants a module reads: pipelines that differ in no other are the same.

use std::collections::{HashMap, HashSet};

/// Specialisation constants that there are; their ids count from 0.
pub(super) const CONSTANTS: usize = 4;
const ALL: u32 = u32::MAX;
/// Words before a module's first instruction.
const HEADER: usize = 5;

mod op {
    pub(super) const CONSTANT: u32 = 43;
    pub(super) const SPEC_CONSTANT_TRUE: u32 = 48;
    pub(super) const SPEC_CONSTANT_FALSE: u32 = 49;
    pub(super) const SPEC_CONSTANT: u32 = 50;
    pub(super) const SPEC_CONSTANT_OP: u32 = 52;
    pub(super) const DECORATE: u32 = 71;
    pub(super) const BITWISE_AND: u32 = 199;
    /// What names and describes, and has no operand that is read: OpSourceContinued to OpLine, OpExtension,
    /// OpExtInstImport, OpMemoryModel to OpCapability, OpTypeInt, OpTypeFloat, OpMemberDecorate, OpModuleProcessed.
    pub(super) const SILENT: [u32; 17] = [2, 3, 4, 5, 6, 7, 8, 10, 11, 14, 15, 16, 17, 21, 22, 72, 330];
}
const DECORATION_SPEC_ID: u32 = 1;

/// What is calculated from specialisation constants.
struct Calculation<'a> {
    operation: u32,
    operands: &'a [u32],
}

#[derive(Default)]
struct Module<'a> {
    /// Constant's id to its place.
    places: HashMap<u32, usize>,
    /// Id to value.
    plain: HashMap<u32, u32>,
    calculations: HashMap<u32, Calculation<'a>>,
    /// What instructions have for operands. Literals count too: one that is taken for an id adds bits, and so shares less.
    used: HashSet<u32>,
}

/// The bits that `words` read of each constant: those of a constant that is only masked are the masks', where what
/// comes of it is used; of any other that is used all.
pub(super) fn bits_read(words: &[u32]) -> [u32; CONSTANTS] {
    let Some(module) = parse(words) else { return [ALL; CONSTANTS] };
    let mut bits = [0; CONSTANTS];
    let mut left: Vec<u32> = module.used.iter().copied().collect();
    let mut seen = HashSet::new();
    while let Some(id) = left.pop() {
        if !seen.insert(id) {
            continue;
        }
        if let Some(place) = module.places.get(&id) {
            bits[*place] = ALL;
        } else if let Some(calculation) = module.calculations.get(&id) {
            match masked(&module, calculation) {
                Some((place, mask)) => bits[place] |= mask,
                None => left.extend(calculation.operands),
            }
        }
    }
    bits
}

/// A constant's place and what it is masked with, in either order.
fn masked(module: &Module<'_>, calculation: &Calculation<'_>) -> Option<(usize, u32)> {
    let (op::BITWISE_AND, &[a, b]) = (calculation.operation, calculation.operands) else { return None };
    let pair = |constant, mask| Some((*module.places.get(constant)?, *module.plain.get(mask)?));
    pair(&a, &b).or_else(|| pair(&b, &a))
}

/// `None`: the words are no module, or one with constants that nobody knows.
fn parse(words: &[u32]) -> Option<Module<'_>> {
    let mut module = Module::default();
    let mut rest = words.get(HEADER..)?;
    while let Some(first) = rest.first() {
        let (instruction, following) = rest.split_at_checked((first >> 16) as usize)?;
        let operands = instruction.get(1..)?;
        match (first & 0xffff, operands) {
            (op::DECORATE, &[id, DECORATION_SPEC_ID, place]) => {
                let place = usize::try_from(place).ok().filter(|place| *place < CONSTANTS)?;
                module.places.insert(id, place);
            }
            (op::CONSTANT, &[_, id, value]) => _ = module.plain.insert(id, value),
            (op::SPEC_CONSTANT_OP, &[_, id, operation, ref operands @ ..]) => {
                module.calculations.insert(id, Calculation { operation, operands });
            }
            (op::DECORATE | op::CONSTANT | op::SPEC_CONSTANT_TRUE | op::SPEC_CONSTANT_FALSE | op::SPEC_CONSTANT, _) => {
            }
            (silent, _) if op::SILENT.contains(&silent) => {}
            (_, operands) => module.used.extend(operands),
        }
        rest = following;
    }
    Some(module)
}

#[cfg(test)]
mod tests {
    use super::{ALL, bits_read};
    use crate::features::Features;
    use crate::gpu::{BAKE, Backend, DILATE, TRACE};

    const FEATURES: u32 = 100;
    const STACK_SIZE: u32 = 101;
    const UINT: u32 = 102;

    fn instruction(op: u32, operands: &[u32]) -> Vec<u32> {
        [&[(operands.len() as u32 + 1) << 16 | op], operands].concat()
    }

    /// Two constants, of which the first is masked with 4 (id 111), 24 (id 113) and itself by 1 (id 115), and more.
    fn module(more: &[Vec<u32>]) -> Vec<u32> {
        let mut words = vec![0x0723_0203, 0x0001_0600, 0, 200, 0];
        let start = [
            instruction(5, &[FEATURES, 0x0041]),
            instruction(71, &[FEATURES, 1, 0]),
            instruction(71, &[STACK_SIZE, 1, 1]),
            instruction(50, &[UINT, FEATURES, ALL]),
            instruction(50, &[UINT, STACK_SIZE, 64]),
            instruction(43, &[UINT, 110, 4]),
            instruction(43, &[UINT, 112, 24]),
            instruction(52, &[UINT, 111, 199, FEATURES, 110]),
            instruction(52, &[UINT, 113, 199, 112, FEATURES]),
            instruction(52, &[UINT, 114, 171, 113, 110]),
        ];
        words.extend(start.concat());
        words.extend(more.concat());
        words
    }

    fn use_of(id: u32) -> Vec<u32> {
        instruction(250, &[id, 120, 121])
    }

    #[test]
    fn what_is_only_calculated_is_not_read() {
        assert_eq!(bits_read(&module(&[])), [0; 4]);
        assert_eq!(bits_read(&module(&[instruction(5, &[111, 0x0041])])), [0; 4]);
    }

    #[test]
    fn masks_tell_the_bits() {
        assert_eq!(bits_read(&module(&[use_of(111)])), [4, 0, 0, 0]);
        // By way of a comparison, and with the mask first.
        assert_eq!(bits_read(&module(&[use_of(114)])), [24, 0, 0, 0]);
        assert_eq!(bits_read(&module(&[use_of(111), use_of(114)])), [28, 0, 0, 0]);
    }

    #[test]
    fn any_other_use_reads_all() {
        assert_eq!(bits_read(&module(&[use_of(FEATURES)])), [ALL, 0, 0, 0]);
        let shift = instruction(52, &[UINT, 115, 194, FEATURES, 110]);
        assert_eq!(bits_read(&module(&[shift, use_of(115)])), [ALL, 0, 0, 0]);
        let by_another = instruction(52, &[UINT, 115, 199, FEATURES, STACK_SIZE]);
        assert_eq!(bits_read(&module(&[by_another, use_of(115)])), [ALL, ALL, 0, 0]);
        // An array's length.
        assert_eq!(bits_read(&module(&[instruction(28, &[130, UINT, STACK_SIZE])])), [0, ALL, 0, 0]);
    }

    #[test]
    fn what_cannot_be_parsed_reads_all() {
        let whole = module(&[use_of(111)]);
        assert_eq!(bits_read(&whole[..whole.len() - 1]), [ALL; 4]);
        assert_eq!(bits_read(&module(&[vec![0]])), [ALL; 4]);
        assert_eq!(bits_read(&module(&[instruction(71, &[FEATURES, 1, 9])])), [ALL; 4]);
        assert_eq!(bits_read(&[]), [ALL; 4]);
    }

    #[test]
    fn shaders_read_what_they_are_for() {
        assert_eq!(bits_read(&DILATE.words(Backend::Software)), [0; 4]);
        let [features, stack_size, query, texel_buffers] = bits_read(&BAKE.words(Backend::Software));
        assert_eq!([stack_size, query, texel_buffers], [ALL, 0, ALL]);
        let read = Features::IMPORTANCE | Features::SKY_MAP;
        assert_eq!(features & read.bits(), read.bits());
        // How the light map is drawn is not the rays' concern.
        assert_eq!(features & Features::LIGHTS.bits(), 0);
        let [_, stack_size, query, texel_buffers] = bits_read(&BAKE.words(Backend::RayQuery));
        assert_eq!([stack_size, query, texel_buffers], [0; 3]);
        assert_eq!(bits_read(&TRACE.words(Backend::RayQuery)), [0, 0, ALL, 0]);
    }
}
