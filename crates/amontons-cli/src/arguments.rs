//! Commands and flags.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use amontons::case::{self, Case, CaseError, Source};
use amontons::hypotheses;
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use crate::team::Team;

/// Contact of deformable bodies with friction and heat
#[derive(Debug, Parser)]
#[command(
    name = "amontons",
    version,
    after_help = "Exit codes: 0 done, 1 a check did not hold, 2 bad usage, case file or mesh, 3 the solver did not converge,\n\
                  4 a file could not be read or written, 130 interrupted (a checkpoint is left)."
)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a case, write results, print a summary
    Run {
        /// The case file
        case: PathBuf,
        /// Draw the results too
        #[arg(long)]
        plot: bool,
        /// Write `report.html` too
        #[arg(long)]
        report: bool,
        /// Bound the discretization error, as with `output.error=true`
        #[arg(long)]
        error: bool,
        /// Refine until the error is at most this part of the solution: in the norm of the energy, or of the numbers
        /// after `--of`
        #[arg(long, value_name = "PART", conflicts_with = "each")]
        accuracy: Option<f64>,
        /// With `--accuracy`: the probes, or columns of `history.csv` and `probes.csv`, whose value at the end is to be
        /// as accurate
        #[arg(long, value_name = "NAME,NAME,…", value_delimiter = ',', requires = "accuracy")]
        of: Vec<String>,
        #[command(flatten)]
        certificate: CertificateChoice,
        /// Keep the results of earlier runs: write into the first of NAME, NAME-2, NAME-3, … that is not there
        #[arg(long, conflicts_with_all = ["each", "force"])]
        again: bool,
        /// Make one run per value, each in its own folder, with one table and one picture; repeatable: all combinations
        #[arg(long, value_name = "KEY=VALUE,VALUE,…")]
        each: Vec<String>,
        /// Runs of `--each` at a time, which share the threads
        #[arg(long, value_name = "N", default_value = "1", requires = "each")]
        jobs: NonZeroUsize,
        #[command(flatten)]
        common: Common,
    },
    /// Go on from the newest checkpoint of a run
    Resume {
        /// The results folder of the run
        dir: PathBuf,
        /// Draw the results too
        #[arg(long)]
        plot: bool,
        /// Write `report.html` too
        #[arg(long)]
        report: bool,
        #[command(flatten)]
        certificate: CertificateChoice,
        #[command(flatten)]
        common: Common,
    },
    /// Read and validate a case; solve nothing
    Check {
        /// The case file
        case: PathBuf,
        /// Tabulate the constants of the domain on these meshes too: cells per side, coarsest first
        #[arg(long, value_delimiter = ',', value_name = "N,N,…")]
        levels: Vec<usize>,
        /// Draw the sides, each in its colour, into NAME.svg and NAME.png
        #[arg(long, value_name = "NAME")]
        plot: Option<PathBuf>,
        #[command(flatten)]
        common: Common,
    },
    /// Convergence study with observed orders
    Converge {
        /// The case file
        case: PathBuf,
        #[command(flatten)]
        study: StudyArguments,
        #[command(flatten)]
        common: Common,
    },
    /// Modes of the state at the end of a run: squeal and hot spots, with a count that shows that none is missing
    Modes {
        /// The case file; `[stability]` says what is looked for
        case: PathBuf,
        #[command(flatten)]
        modes: ModesArguments,
        #[command(flatten)]
        common: Common,
    },
    /// Derivatives of numbers at the end of a run by keys of the case
    Gradient {
        /// The case file
        case: PathBuf,
        /// Numbers at the end: columns of probes, `final.contact.force.0`, `final.contact.wear_volume`,
        /// `energy.friction_dissipation`
        #[arg(long, value_delimiter = ',', required = true, value_name = "OUTPUT,OUTPUT,…")]
        of: Vec<String>,
        /// Keys with numbers, as for `--set`
        #[arg(long, value_delimiter = ',', required = true, value_name = "KEY,KEY,…")]
        with: Vec<String>,
        #[command(flatten)]
        common: Common,
    },
    /// Find the values of keys with which a run comes nearest to what was measured
    Fit {
        /// The case file, with the values to start from
        case: PathBuf,
        #[command(flatten)]
        fit: FitArguments,
        #[command(flatten)]
        common: Common,
    },
    /// Draw a finished run or study
    Plot {
        /// The results folder
        dir: PathBuf,
        /// Times of the frames, rounded to the nearest snapshot [default: the end, or up to four frames if most changes
        /// happen before]
        #[arg(long, value_delimiter = ',', value_name = "T,T,…")]
        time: Vec<f64>,
        /// Leave out the units, also those of a case with units = "SI"
        #[arg(long)]
        dimensionless: bool,
        /// Factor of the displacement in the picture of the deformed body [default: 1 beside obstacles, else a round
        /// number]
        #[arg(long, value_name = "F")]
        scale: Option<f64>,
        /// Pixels per unit of 1/96 inch [default: 2 of a PNG, 1 of an animation]
        #[arg(long, value_name = "P")]
        pixels: Option<f64>,
        /// Write an animation of the deformed body (GIF) in place of pictures, coloured by this field
        #[arg(long, value_enum, value_name = "FIELD", num_args = 0..=1, require_equals = true,
              default_missing_value = "displacement")]
        animate: Option<FieldArgument>,
    },
    /// Write `report.html`: a finished run or study as one page for a browser, without network
    Report {
        /// The results folder
        dir: PathBuf,
    },
    /// Compare runs with the reference values of a case or of the shipped benchmarks
    Verify {
        /// Case files with `[expected]` or `[verify]`, results folders, whose figures are recomputed, or benchmarks
        /// [default: all benchmarks]
        names: Vec<String>,
        #[command(flatten)]
        common: Common,
    },
    /// The paper's figures for three readings of its tensors, with a report
    Reproduce {
        /// Levels of the convergence studies: cells per side
        #[arg(long, value_delimiter = ',', default_values_t = [16, 32, 64, 128])]
        levels: Vec<usize>,
        /// Level of the reference solution
        #[arg(long, default_value_t = 256)]
        reference: usize,
        #[command(flatten)]
        common: Common,
    },
    /// Say what a key, a quantity, a column or a finding means
    Explain {
        /// The word, such as `coefficient`, `contact.friction.coefficient`, `von_mises`, `few-points` [default: all of
        /// them, as the chapter "Reference" of the guide]
        word: Option<String>,
        /// Form of what is printed on standard output
        #[arg(long, value_enum, default_value_t = OutputFormat::Text)]
        format: OutputFormat,
    },
    /// Show what a mesh has: regions, sides, sizes, the quality of its cells
    Mesh {
        /// The file, .msh (Gmsh), .inp (Abaqus, CalculiX), .med and .mail (Code_Aster, Salome), .e (Exodus) or .vtu
        /// (VTK), or a case, whose mesh is shown with the sides that it names
        file: PathBuf,
        /// Draw the sides, each in its colour, into NAME.svg and NAME.png
        #[arg(long, value_name = "NAME")]
        plot: Option<PathBuf>,
        /// Factor of the coordinates: 0.001 if the file is in mm
        #[arg(long, value_name = "F", default_value_t = 1.0)]
        scale: f64,
        /// Refuse a link that leads out of the folder of the file
        #[arg(long)]
        confine: bool,
        /// Form of what is printed on standard output
        #[arg(long, value_enum, default_value_t = OutputFormat::Text)]
        format: OutputFormat,
    },
    /// Write a case from an input deck of Abaqus or CalculiX
    Import {
        /// The deck
        deck: PathBuf,
        /// The case file to write [default: that of the deck, ending in .toml]
        #[arg(long, value_name = "CASE")]
        out: Option<PathBuf>,
        /// Units of the deck; with any but `none` the case is in SI
        #[arg(long, value_enum, default_value_t = DeckUnits::None)]
        units: DeckUnits,
        /// Replace the files that are there
        #[arg(long)]
        force: bool,
    },
    /// Print the JSON Schema of the case file
    Schema,
    /// List the materials that a case may name, or the values and the source of one
    Materials {
        /// Its name
        name: Option<String>,
    },
    /// Write a commented case to start from
    New {
        /// The file to write; an existing file is kept
        file: PathBuf,
        /// Which case to write
        #[arg(long, value_enum, default_value_t = Template::Starter)]
        template: Template,
        /// The mesh file of the template `from-mesh`
        #[arg(long, value_name = "MESH", required_if_eq("template", "from-mesh"))]
        mesh: Option<PathBuf>,
    },
    /// Print the manual page of the program, or of one of its commands, for `man`
    Man {
        /// The command
        command: Option<String>,
    },
    /// Print shell completions
    Completions {
        /// The shell
        shell: Shell,
    },
}

/// A field of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FieldArgument {
    /// The magnitude of the displacement
    Displacement,
    /// The von Mises stress
    VonMises,
    /// The temperature
    Temperature,
}

/// A case to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Template {
    /// A block that is pushed onto a foundation, with every key explained
    Starter,
    /// The example of the paper
    Paper,
    /// A gasket between two flanges
    Seal,
    /// A brake pad on a disc that heats up
    Brake,
    /// Two rings of revolution with an interference
    PressFit,
    /// The sides and regions of a mesh file, given by `--mesh`
    FromMesh,
}

/// The units that the numbers of a deck are in, which no deck says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DeckUnits {
    /// Not known: the case has the numbers of the deck and no units
    None,
    /// mm, t, s: forces in N, stresses in MPa
    #[value(name = "mm-N-s")]
    MmNS,
    /// m, kg, s: SI
    #[value(name = "m-kg-s")]
    MKgS,
    /// mm, kg, ms: forces in kN, stresses in GPa
    #[value(name = "mm-kg-ms")]
    MmKgMs,
}

#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Levels, coarsest first: cells per side, or numbers of steps if time is refined
    #[arg(long, value_delimiter = ',', required = true, value_name = "N,N,…")]
    pub levels: Vec<usize>,
    /// Level of the reference solution [default: the finest level]
    #[arg(long, value_name = "N")]
    pub reference: Option<usize>,
    /// Compare with the closed form in `[exact]` of the case
    #[arg(long, conflicts_with = "reference")]
    pub exact: bool,
    /// What is refined
    #[arg(long, value_enum, default_value_t = VaryArgument::Both)]
    pub vary: VaryArgument,
    /// Make one study per value, each in its own folder; repeatable
    #[arg(long, value_name = "KEY=VALUE,VALUE,…")]
    pub each: Vec<String>,
}

#[derive(Debug, Args)]
pub struct ModesArguments {
    /// Find the modes for each value, with one table and a picture of frequency and growth; repeatable: all
    /// combinations
    #[arg(long, value_name = "KEY=VALUE,VALUE,…")]
    pub each: Vec<String>,
    /// Find the value of a key between two numbers at which a mode begins to grow
    #[arg(long, value_name = "KEY=FROM,TO")]
    pub critical: Option<String>,
    /// Derivatives of growth and frequency by keys with numbers, as for `--set`; with `--critical` also those of the
    /// value found
    #[arg(long, value_delimiter = ',', value_name = "KEY,KEY,…")]
    pub with: Vec<String>,
    /// Write an animation of a mode (GIF), by its number in the table
    #[arg(long, value_name = "N")]
    pub animate: Option<NonZeroUsize>,
}

#[derive(Debug, Args)]
pub struct FitArguments {
    /// Measured values: a column `t`, and one under the name of each output (a column of probes.csv or history.csv);
    /// with `_sigma` behind it its standard deviations
    #[arg(long, value_name = "FILE")]
    pub data: PathBuf,
    /// Keys with numbers, as for `--set`
    #[arg(long, value_delimiter = ',', required = true, value_name = "KEY,KEY,…")]
    pub free: Vec<String>,
    /// Lower and upper bound of a key; either may be left out; repeatable
    #[arg(long, value_name = "KEY=LOW,HIGH")]
    pub bounds: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum VaryArgument {
    /// Mesh and step together
    Both,
    /// The mesh
    Space,
    /// The step
    Time,
}

#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Results folder [default: results/<case name>; of `resume`: the folder of the run]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Set a value of the case: KEY is its dotted path, VALUE is TOML; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Number of threads, at most 64 or four per core; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// How progress is reported on standard error
    #[arg(long, value_enum, default_value_t = ProgressArgument::Auto)]
    pub progress: ProgressArgument,
    /// Print no text but errors, and no progress
    #[arg(long)]
    pub quiet: bool,
    /// Form of what is printed on standard output
    #[arg(long, value_enum, default_value_t = OutputFormat::Text)]
    pub format: OutputFormat,
    /// Refuse meshes and tables outside the folder of the case
    #[arg(long)]
    pub confine: bool,
    /// Replace existing results in the folder once the new run has made its first step
    #[arg(long)]
    pub force: bool,
    /// The processes that execute the command together
    #[arg(skip)]
    pub team: Team,
}

/// Which hypotheses a run evaluates.
#[derive(Clone, Copy, Debug, Args)]
pub struct CertificateChoice {
    /// Evaluate all hypotheses; by default a run leaves out those that would take more than about a tenth of it
    #[arg(long, conflicts_with = "no_certificate")]
    certificate: bool,
    /// Evaluate only the hypotheses that need no factorization
    #[arg(long)]
    no_certificate: bool,
}

impl CertificateChoice {
    /// The choice of the user, if any.
    pub fn asked(self) -> Option<bool> {
        (self.certificate || self.no_certificate).then_some(self.certificate)
    }

    /// True if the run of a case evaluates all hypotheses.
    pub fn of(self, case: &Case) -> bool {
        self.asked().unwrap_or_else(|| hypotheses::are_affordable(&case.problem))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OutputFormat {
    /// For reading
    Text,
    /// For programs
    Json,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressArgument {
    /// A bar on a terminal, elsewhere a line per minute
    Auto,
    /// A JSON object per line
    Json,
    /// Nothing
    None,
}

impl Common {
    /// The case in a file, as these arguments allow it to be read.
    pub fn source(&self, file: &Path) -> Result<Source, CaseError> {
        let source = case::source(file)?;
        Ok(self.team.source(if self.confine { source.confined() } else { source }))
    }

    /// The case in a file, with the overrides of these arguments.
    pub fn case(&self, file: &Path) -> Result<Case, CaseError> {
        case::parse(&self.source(file)?, &self.set)
    }
}

impl Command {
    /// The command with the options that stand for keys of the case file.
    pub fn with_choices(mut self) -> Command {
        if let Command::Run { error: true, common, .. } = &mut self {
            common.set.push("output.error=true".to_owned());
        }
        self
    }

    /// In what form messages are printed.
    pub fn format(&self) -> OutputFormat {
        match self {
            Command::Mesh { format, .. } | Command::Explain { format, .. } => *format,
            _ => self.common().map_or(OutputFormat::Text, |common| common.format),
        }
    }

    /// Number of threads that is asked for.
    pub fn threads(&self) -> Option<usize> {
        self.common().and_then(|common| common.threads).map(usize::from)
    }

    /// The arguments that most commands have.
    fn common(&self) -> Option<&Common> {
        match self {
            Command::Run { common, .. }
            | Command::Resume { common, .. }
            | Command::Check { common, .. }
            | Command::Converge { common, .. }
            | Command::Modes { common, .. }
            | Command::Gradient { common, .. }
            | Command::Fit { common, .. }
            | Command::Verify { common, .. }
            | Command::Reproduce { common, .. } => Some(common),
            Command::Plot { .. }
            | Command::Report { .. }
            | Command::Mesh { .. }
            | Command::Import { .. }
            | Command::Explain { .. }
            | Command::Schema
            | Command::Materials { .. }
            | Command::New { .. }
            | Command::Man { .. }
            | Command::Completions { .. } => None,
        }
    }

    /// The arguments of a command that several processes can execute together, or `None`.
    pub fn shared(&mut self) -> Option<&mut Common> {
        match self {
            Command::Run { each, common, .. } if each.is_empty() => Some(common),
            Command::Resume { common, .. } | Command::Verify { common, .. } | Command::Gradient { common, .. } => {
                Some(common)
            }
            _ => None,
        }
    }
}
