//! What can be typed: the one definition from which parsing, `--help`, completions and the man page
//! come. Nothing here looks at a scene or does any work.

use super::values;
use crate::batch::queue::scheduler::ShardChoice;
use crate::jobs::settings::MOST_SAMPLES;
use crate::methods::Method;
use crate::trace::Backend;
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use std::path::PathBuf;

const EXIT_CODES: &str = "Exit codes:
  0         done
  1         a check said no
  2         wrong usage
  3         the input is bad: scene, parameter, mesh, image, job
  4         the system failed: files, memory
  5         a batch finished, some of its jobs failed
  6         check cannot tell: the noise is larger than what it looks for
  130, 143  interrupted; what was finished is on disk";

const EXAMPLES: &str = "Examples:
  warpath render scenes/demo.xml --spp 64 -o out/shadow
  warpath params scenes/demo.xml
  warpath forward scenes/demo.xml --param occluder.translation=1,0,0 --spp 64
  warpath backward scenes/demo.xml --param occluder.vertex_positions --target target.exr --loss l2
  warpath check scenes/demo.xml --param occluder.translation=1,0,0
  warpath batch jobs.jsonl -o out/jobs --resume
  warpath optimize fit.toml --set steps=200 -o out/fit";

/// Gradients of path-traced images, through visibility, on the CPU.
///
/// Scenes are a subset of Mitsuba 3 XML. What an option does not say comes from the scene.
#[derive(Debug, Parser)]
#[command(
    name = "warpath",
    version,
    max_term_width = 100,
    arg_required_else_help = true
)]
#[command(after_help = EXIT_CODES, after_long_help = const_format(), disable_help_subcommand = true)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

fn const_format() -> String {
    format!("{EXAMPLES}\n\n{EXIT_CODES}")
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Renders the image: image.exr, image.png
    #[command(
        after_help = "Example: warpath render scene.xml --spp 64 --resolution 640x480 -o out/scene"
    )]
    Render(RenderArguments),
    /// Lists every parameter with its shape, flags and present value
    #[command(after_help = "Example: warpath params scene.xml --json")]
    Params(ParamsArguments),
    /// Forward: the gradient image dI/dθ along one direction
    ///
    /// Writes gradient.exr, gradient.npy, gradient.png (blue below zero, red above, the scale in
    /// the picture), stderr.npy and image.exr.
    #[command(
        after_help = "Example: warpath forward scene.xml --param ball.translation=1,0,0 --param cam.x_fov=0.5 --spp 64"
    )]
    Forward(ForwardArguments),
    /// Backward: gradients of a loss for all the keys, in one pass or by few differences
    ///
    /// Writes gradients.safetensors and gradients.npz (one tensor a key, KEY#se its standard error)
    /// and image.exr.
    #[command(
        after_help = "Example: warpath backward scene.xml --param ball.vertex_positions --target photo.exr --loss l1"
    )]
    Backward(BackwardArguments),
    /// Forward, backward and finite differences against each other; exit code 1 if they disagree
    ///
    /// Runs each several times with other random numbers, until a bias as large as the tolerance
    /// could be seen, and says in a sentence what was. Writes check.json and three images: forward,
    /// fd and z, the difference in standard errors.
    #[command(
        after_help = "Example: warpath check scene.xml --param ball.translation=1,0,0 --resolution 64x64 --spp 64"
    )]
    Check(CheckArguments),
    /// Embree against obvhs: building, refitting, memory, rays, whole gradients
    ///
    /// On generated meshes of three classes, or on the scenes and meshes given. Prints a table;
    /// writes bench.json and bench.svg. Times are those of an otherwise idle machine only if it is
    /// one.
    #[command(after_help = "Example: warpath bench --triangles 20000 --seconds 0.1 -o out/bench")]
    Bench(BenchArguments),
    /// Runs many jobs: renderings and gradients, one JSON object a line
    ///
    /// Scenes are loaded once, jobs share all threads, and nothing that is finished is lost. Writes
    /// results.jsonl, a folder for each job and report.json. With - as the file it answers lines of
    /// standard input, each with a line on standard output, until there are no more.
    #[command(
        after_help = "Example: warpath batch jobs.jsonl -o out/jobs --resume\nExample: srun -n 4 warpath batch jobs.jsonl --shard auto -o 'out/{shard}'"
    )]
    Batch(BatchArguments),
    /// Puts the shards of a batch together
    ///
    /// Collects jobs, or adds up their samples: exactly, however many shards there were. Exit code
    /// 1 if they are not all the shards of one batch.
    #[command(after_help = "Example: warpath merge out/1-of-2 out/2-of-2 -o out/all")]
    Merge(MergeArguments),
    /// Inverse rendering: from pictures to shape, pose, light and material
    ///
    /// Moves parameters of a scene until its images are those of the targets. docs/optimize.md has
    /// every key of the configuration. Writes the loss curve, pictures of every view, the page
    /// index.html, meshes, textures, the final scene, a checkpoint and report.json.
    #[command(
        after_help = "Example: warpath optimize fit.toml --set optimizer.lr=0.02 -o out/fit\nExample: warpath optimize fit.toml -o out/fit --resume"
    )]
    Optimize(OptimizeArguments),
    /// Scenes × directions × methods × samples: error against time, with verdicts
    ///
    /// Makes references by finite differences, measures every method in turns, and writes
    /// study.json, study.csv, charts, gradient pictures and one HTML page.
    #[command(
        after_help = "Example: warpath study scenes/failures/study.toml --report stability.md -o out/failures"
    )]
    Study(StudyArguments),
    /// Prints a completion script for a shell
    Completions {
        /// The shell to complete in
        shell: Shell,
    },
    /// Prints the manual page
    Man,
}

/// The scene and how it is read.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// Scene file (Mitsuba 3 XML)
    pub scene: PathBuf,
    /// Gives a value to a $name of the scene
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = values::definition)]
    pub defines: Vec<(String, String)>,
    /// Which of the scene's sensors renders
    #[arg(short, long, value_name = "I", default_value_t = 0)]
    pub sensor: usize,
}

/// How the command talks.
#[derive(Debug, Args)]
pub struct TalkArguments {
    /// Prints the report (or the list) as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Prints nothing but errors on stderr
    #[arg(short, long)]
    pub quiet: bool,
    /// How messages and progress are written to stderr
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = LogFormat::Text)]
    pub log_format: LogFormat,
}

/// What every command that traces rays takes.
#[derive(Debug, Args)]
pub struct TraceArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Camera paths per pixel [default: the scene's sample_count]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)))]
    pub spp: Option<u32>,
    /// Seed of the random numbers [default: the scene's]
    #[arg(long, value_name = "S")]
    pub seed: Option<u64>,
    /// Threads [default: the cores this process may use]
    #[arg(short, long, value_name = "T", value_parser = values::threads)]
    pub threads: Option<usize>,
    /// Longest path in segments, -1 for no limit [default: the scene's]
    #[arg(long, value_name = "D", value_parser = values::depth, allow_negative_numbers = true)]
    pub max_depth: Option<u32>,
    /// Size of the image in pixels [default: the scene's film]
    #[arg(long, value_name = "WxH", value_parser = values::resolution)]
    pub resolution: Option<[u32; 2]>,
    /// What traces the rays: embree, obvhs or obvhs-bvh2; with a preset of its build after a colon,
    /// as obvhs:slow
    #[arg(long, value_name = "BACKEND", default_value_t)]
    pub backend: Backend,
    /// Directory for the files [default: out/COMMAND-SCENE]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub talk: TalkArguments,
}

/// `warpath render`
#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    pub trace: TraceArguments,
}

/// `warpath params`
#[derive(Debug, Args)]
pub struct ParamsArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    #[command(flatten)]
    pub talk: TalkArguments,
}

/// `warpath forward`
#[derive(Debug, Args)]
pub struct ForwardArguments {
    #[command(flatten)]
    pub trace: TraceArguments,
    /// A parameter and its tangent: its numbers, those of one row for all rows, or @file.npy of its
    /// shape; several make one direction
    #[arg(short, long = "param", value_name = "KEY=TANGENT", required = true, value_parser = values::tangent)]
    pub parameters: Vec<values::Tangent>,
    /// How visibility is differentiated
    #[arg(short, long, value_parser = values::method(), default_value = Method::default().name())]
    pub method: String,
    /// Says what the pilot of auto tried, and what came of it
    #[arg(long)]
    pub explain: bool,
    /// Leaves standard errors out, which saves their memory
    #[arg(long)]
    pub no_stderr: bool,
}

/// `warpath backward`
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("objective").required(true).args(["adjoint", "target"]))]
pub struct BackwardArguments {
    #[command(flatten)]
    pub trace: TraceArguments,
    /// A parameter to differentiate with respect to; repeat for more
    #[arg(short, long = "param", value_name = "KEY", required = true, value_parser = values::bare_key)]
    pub parameters: Vec<String>,
    /// The derivative of the loss by the image (.exr, .npy)
    #[arg(long, value_name = "FILE")]
    pub adjoint: Option<PathBuf>,
    /// The image to compare with (.exr, .npy)
    #[arg(long, value_name = "FILE")]
    pub target: Option<PathBuf>,
    /// How it is compared: the mean over pixels and channels of |difference| or of its square
    #[arg(long, value_enum, default_value_t = Loss::L2, conflicts_with = "adjoint")]
    pub loss: Loss,
    /// How visibility is differentiated
    #[arg(short, long, value_parser = values::method(), default_value = Method::default().name())]
    pub method: String,
    /// Says what the pilot of auto tried, and what came of it
    #[arg(long)]
    pub explain: bool,
    /// Leaves standard errors out, which saves their memory
    #[arg(long)]
    pub no_stderr: bool,
}

/// `warpath check`
#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    pub trace: TraceArguments,
    /// A parameter and its tangent, as in forward
    #[arg(short, long = "param", value_name = "KEY=TANGENT", required = true, value_parser = values::tangent)]
    pub parameters: Vec<values::Tangent>,
    /// The method to check against finite differences
    #[arg(short, long, value_parser = values::method(), default_value = Method::default().name())]
    pub method: String,
    /// What is significant but smaller than this passes: of the gradient along the image of finite
    /// differences, and of its RMS over blocks of 8x8 pixels (of single pixels, thrice this)
    #[arg(long, value_name = "SHARE", default_value_t = 0.03, value_parser = values::share)]
    pub tolerance: f64,
    /// Goes on with more runs as long as it cannot tell, however long that takes
    #[arg(long)]
    pub until_sure: bool,
}

/// `warpath bench`
#[derive(Debug, Args)]
pub struct BenchArguments {
    /// Scenes (.xml) and meshes (.ply, .obj) to measure on [default: generated meshes]
    pub files: Vec<PathBuf>,
    /// Sizes of the generated meshes
    #[arg(long, value_name = "N,N…", value_delimiter = ',', default_value = "20000,200000,1800000", value_parser = clap::value_parser!(u32).range(100..=100_000_000))]
    pub triangles: Vec<u32>,
    /// Time to repeat each measurement for
    #[arg(long, value_name = "S", default_value_t = 0.25, value_parser = values::seconds)]
    pub seconds: f64,
    /// Threads, beside one [default: the cores this process may use]
    #[arg(short, long, value_name = "T", value_parser = values::threads)]
    pub threads: Option<usize>,
    /// Directory for the files [default: out/bench]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub talk: TalkArguments,
}

/// `warpath batch`
#[derive(Debug, Args)]
pub struct BatchArguments {
    /// File with a job a line, or - for standard input
    #[arg(required_unless_present = "schema")]
    pub jobs: Option<PathBuf>,
    /// Directory for the results; {shard} in it becomes I-of-N [default: out/batch-JOBS]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Goes on with the results that are there; what failed is tried again
    #[arg(long)]
    pub resume: bool,
    /// Threads [default: the cores this process may use]
    #[arg(short, long, value_name = "T", value_parser = values::threads)]
    pub threads: Option<usize>,
    /// Memory that scenes and jobs may take
    #[arg(long, value_name = "AMOUNT", value_parser = values::memory, default_value = "50%")]
    pub memory: values::Memory,
    /// Does one part of N; auto asks Slurm, Open MPI, PMI or Kubernetes which (auto/N where they do
    /// not tell N)
    #[arg(long, value_name = "I/N|auto", value_parser = values::shard)]
    pub shard: Option<ShardChoice>,
    /// What shards share out
    #[arg(long, value_enum, default_value_t = SplitName::Jobs, requires = "shard")]
    pub split: SplitName,
    /// What traces the rays of all jobs, as in forward
    #[arg(long, value_name = "BACKEND", default_value_t)]
    pub backend: Backend,
    /// Prints the JSON schema of a job
    #[arg(long, exclusive = true)]
    pub schema: bool,
    #[command(flatten)]
    pub talk: TalkArguments,
}

/// `warpath merge`
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Folders of all shards of a batch
    #[arg(required = true, value_name = "DIR")]
    pub shards: Vec<PathBuf>,
    /// Directory for the results
    #[arg(short, long, value_name = "DIR", default_value = "out/merged")]
    pub output: PathBuf,
    #[command(flatten)]
    pub talk: TalkArguments,
}

/// `warpath optimize`
#[derive(Debug, Args)]
pub struct OptimizeArguments {
    /// What to optimise, and how (TOML)
    pub config: PathBuf,
    /// Gives another value to a key of the configuration; repeat for more
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    /// Directory for the files [default: out/optimize-CONFIG]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Goes on from the checkpoint in the directory, or begins if there is none
    #[arg(long)]
    pub resume: bool,
    /// Begins anew though the directory has a checkpoint, whose run's files are taken away
    #[arg(long, conflicts_with = "resume")]
    pub fresh: bool,
    /// Threads [default: the cores this process may use]
    #[arg(short, long, value_name = "T", value_parser = values::threads)]
    pub threads: Option<usize>,
    /// What traces the rays, as in forward
    #[arg(long, value_name = "BACKEND", default_value_t)]
    pub backend: Backend,
    #[command(flatten)]
    pub talk: TalkArguments,
}

/// `warpath study`
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// What to measure (TOML; docs/study.md)
    pub config: PathBuf,
    /// Overrides a value of the configuration, as in repeats=8 or reference.spp=256
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Only these scenes of it
    #[arg(long, value_name = "NAME,NAME…", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Directory for the results [default: out/study-CONFIG]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Goes on with the results that are there
    #[arg(long)]
    pub resume: bool,
    /// Exit code 1 if a figure is beyond a bound of this file
    #[arg(long, value_name = "FILE")]
    pub assert: Option<PathBuf>,
    /// Also writes scene × method as a Markdown table
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Where references are kept and looked for [default: references in the results]
    #[arg(long, value_name = "DIR")]
    pub references: Option<PathBuf>,
    /// Threads [default: the cores this process may use]
    #[arg(short, long, value_name = "T", value_parser = values::threads)]
    pub threads: Option<usize>,
    /// What traces the rays, as in forward
    #[arg(long, value_name = "BACKEND", default_value_t)]
    pub backend: Backend,
    #[command(flatten)]
    pub talk: TalkArguments,
}

/// What shards share out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SplitName {
    /// Jobs
    Jobs,
    /// The samples of every job
    Samples,
}

/// How stderr is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// For people
    Text,
    /// One JSON object a line
    Json,
}

/// How an image is compared with its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Loss {
    L1,
    L2,
}
