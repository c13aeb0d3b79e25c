//! How much memory was used.

/// The largest memory this process has held so far \[bytes\], where the system says (Linux: `VmHWM`).
pub fn peak_memory() -> Option<u64> {
    peak_of(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn peak_of(status: &str) -> Option<u64> {
    let kib = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix("kB")?;
    kib.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_from_the_status_of_the_process() {
        assert_eq!(peak_of("Name:\tx\nVmHWM:\t   20480 kB\nVmRSS:\t 1 kB\n"), Some(20_971_520));
        assert_eq!(peak_of("Name:\tx\n"), None);
    }
    #[cfg(target_os = "linux")]
    #[test]
    fn a_running_test_has_some_memory() {
        assert!(peak_memory().is_some_and(|bytes| bytes > 100_000));
    }
}
