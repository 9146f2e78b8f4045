//! Runs the program and watches its time and memory.

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Of all threads together: a busy machine does not make this longer.
const MOST_PROCESSOR_SECONDS: f64 = 20.0;
/// For what waits and does nothing.
const MOST_SECONDS: f64 = 120.0;
/// Beyond any limit a case may have: the process is ended before the machine suffers.
const MOST_BYTES: u64 = 2 << 30;
/// What Linux counts processor time in, on every architecture.
const TICKS_PER_SECOND: f64 = 100.0;

/// How a process ended.
pub struct Ended {
    /// None after a signal.
    pub code: Option<i32>,
    pub signal: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: Vec<u8>,
    /// The most memory it was seen to hold.
    pub peak_bytes: u64,
    /// Why it was ended, if it did not end by itself.
    pub killed: Option<&'static str>,
}

/// Runs the program in `directory`; its output goes through files beside it.
pub fn run(directory: &Path, beside: &Path, arguments: &[String], input: Option<&[u8]>) -> Ended {
    let [out, err, standard_input] = ["stdout", "stderr", "stdin"].map(|n| beside.join(n));
    fs::write(&standard_input, input.unwrap_or_default()).expect("a file of input");
    let open = |path: &Path| Stdio::from(File::create(path).expect("a file for output"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(arguments)
        .current_dir(directory)
        .env_remove("RUST_BACKTRACE")
        .stdin(File::open(&standard_input).expect("the file of input"))
        .stdout(open(&out))
        .stderr(open(&err))
        .spawn()
        .expect("the program starts");
    let (peak_bytes, killed) = watch(&mut child);
    let status = child.wait().expect("an end");
    Ended {
        code: status.code(),
        signal: status.signal(),
        stdout: fs::read(&out).expect("output"),
        stderr: fs::read(&err).expect("messages"),
        peak_bytes,
        killed,
    }
}

/// Waits for the end, or brings it about.
fn watch(child: &mut Child) -> (u64, Option<&'static str>) {
    let started = Instant::now();
    let folder = format!("/proc/{}", child.id());
    let mut peak = 0;
    let mut pause = Duration::from_micros(500);
    while child.try_wait().expect("a child").is_none() {
        peak = peak.max(peak_bytes(&folder));
        let why = if peak > MOST_BYTES {
            Some("it takes more than 2 GiB")
        } else if processor_seconds(&folder) > MOST_PROCESSOR_SECONDS {
            Some("it works for more than 20 s")
        } else if started.elapsed().as_secs_f64() > MOST_SECONDS {
            Some("it does not end")
        } else {
            None
        };
        if why.is_some() {
            // It may just have ended by itself.
            let _ = child.kill();
            return (peak, why);
        }
        std::thread::sleep(pause);
        pause = (pause * 5 / 4).min(Duration::from_millis(5));
    }
    (peak, None)
}

/// Its high-water mark; 0 where the system does not tell.
fn peak_bytes(folder: &str) -> u64 {
    let status = fs::read_to_string(format!("{folder}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kibibytes.unwrap_or(0) << 10
}

fn processor_seconds(folder: &str) -> f64 {
    let stat = fs::read_to_string(format!("{folder}/stat")).unwrap_or_default();
    // After the name, which may hold spaces: state is field 3, times are 14 and 15.
    let fields = stat.rsplit(')').next().unwrap_or_default();
    let times = fields.split_whitespace().skip(11).take(2);
    let ticks: f64 = times.filter_map(|t| t.parse::<f64>().ok()).sum();
    ticks / TICKS_PER_SECOND
}
