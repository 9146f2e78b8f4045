//! The machine a job runs on: its memory, and what this process has taken of it.

use std::fs;
use std::path::Path;

/// Bytes the process may use: the machine's, or the limit of a control group or of its address
/// space (`ulimit -v`).
pub fn of_machine() -> u64 {
    let machine = kilobytes(Path::new("/proc/meminfo"), "MemTotal:").unwrap_or(4 << 30);
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let groups = groups.lines().filter_map(of_control_group);
    groups.chain(of_address_space()).fold(machine, u64::min)
}

/// The least limit of a control group, as a line of `/proc/self/cgroup` names it, and of those it
/// is in.
fn of_control_group(line: &str) -> Option<u64> {
    let mut fields = line.splitn(3, ':').skip(1);
    let (controllers, group) = (fields.next()?, fields.next()?);
    let (root, file) = match controllers {
        "" => ("/sys/fs/cgroup", "memory.max"),
        names if names.split(',').any(|name| name == "memory") => {
            ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
        }
        _ => return None,
    };
    let number = |path: &Path| -> Option<u64> {
        let text = fs::read_to_string(path.join(file)).ok()?;
        text.trim().parse().ok()
    };
    let group = Path::new(root).join(group.trim_start_matches('/'));
    let all = group.ancestors().take_while(|path| path.starts_with(root));
    all.filter_map(number).min()
}

/// Bytes of memory that the address space has room for, if it is limited: what is in memory, and
/// what may still be mapped.
pub fn of_address_space() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits
        .lines()
        .find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let mapped = kilobytes(Path::new("/proc/self/status"), "VmSize:")?;
    Some(limit.saturating_sub(mapped) + resident()?)
}

/// Bytes the process has now.
pub fn resident() -> Option<u64> {
    kilobytes(Path::new("/proc/self/status"), "VmRSS:")
}

/// The most bytes the process has held, where the system tells.
pub fn peak() -> Option<u64> {
    kilobytes(Path::new("/proc/self/status"), "VmHWM:")
}

/// Has the most bytes counted anew from now on, where the system can.
pub fn forget_peak() {
    // Without it `peak` goes on from the start of the process.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

fn kilobytes(path: &Path, name: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

/// Seconds of all cores together that the process has used.
pub fn processor_seconds() -> Option<f64> {
    // Fields 14 and 15 after the name in parentheses, which may hold spaces; in hundredths, as
    // Linux has told them to user space on every architecture since 2.6.
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}

/// The same to the nanosecond, for what takes milliseconds.
pub fn fine_processor_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(target_os = "linux")]
    fn the_system_tells() {
        assert!(super::peak().is_some_and(|bytes| bytes > 100_000));
        assert!(super::resident() <= super::peak());
        assert!(super::of_machine() > 100_000_000);
        assert!(super::processor_seconds().is_some_and(|s| (0.0..1e6).contains(&s)));
    }
}
