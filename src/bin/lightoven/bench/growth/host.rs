//! Memory that the tool holds on the host, as Linux tells it.

use std::fs;

const STATUS: &str = "/proc/self/status";
/// Takes requests to forget the most that was held.
const CLEAR: &str = "/proc/self/clear_refs";
const FORGET_PEAK: &str = "5";

/// What the tool holds beyond what it held at first.
#[derive(Debug, Clone, Copy)]
pub(super) struct HostMemory {
    at_first: Option<u64>,
}

impl HostMemory {
    pub(super) fn new() -> Self {
        Self { at_first: read("VmRSS") }
    }

    /// What `work` gives, and the most that was held meanwhile beyond what was held at first, bytes; `None` where the
    /// system does not tell.
    pub(super) fn most_during<T>(self, work: impl FnOnce() -> T) -> (T, Option<u64>) {
        let forgotten = fs::write(CLEAR, FORGET_PEAK).is_ok();
        let done = work();
        let most = read("VmHWM").filter(|_| forgotten);
        (done, most.zip(self.at_first).map(|(most, at_first)| most.saturating_sub(at_first)))
    }
}

fn read(name: &str) -> Option<u64> {
    bytes_of(&fs::read_to_string(STATUS).ok()?, name)
}

/// From a line as `VmRSS:   1234 kB`.
fn bytes_of(status: &str, name: &str) -> Option<u64> {
    let value = status.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    value.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_read() {
        let status = "Name:\tlightoven\nVmHWM:\t    2048 kB\nVmRSS:\t      12 kB\nVmRSSx:\t1 kB\n";
        assert_eq!((bytes_of(status, "VmHWM"), bytes_of(status, "VmRSS")), (Some(2 << 20), Some(12 << 10)));
        assert_eq!(
            (bytes_of(status, "Vm"), bytes_of("VmRSS: many kB", "VmRSS"), bytes_of("", "VmRSS")),
            (None, None, None)
        );
    }

    /// A system that tells nothing has no figure; one that does sees what was held and let go of.
    #[test]
    fn a_peak_is_seen() {
        let ((), most) = HostMemory::new().most_during(|| drop(std::hint::black_box(vec![1_u8; 64 << 20])));
        assert!(most.is_none_or(|most| most > 32 << 20), "{most:?}");
    }
}
