//! The command line of the virtual lathe.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use feature_editor::codes::Format;
use virtual_lathe::turn::{self, Job};
use virtual_lathe::{gallery, operate, serve};

/// HandCNC's virtual lathe: runs programs through the firmware's own code, measures and draws the pulses.
#[derive(Parser)]
#[command(name = "virtual-lathe", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run a program (the embedded demo without FILE) and report on its pulse train.
    Turn(Turn),
    /// Operate the lathe as a script says: wheels, joystick, modes, programs, switches; print its final state.
    Operate(Operate),
    /// Let random operators loose on random machines, and look that nothing they do breaks a rule; what fails is made short
    /// and written as a scenario.
    Soak(Soak),
    /// Run the lathe for a sender of G-code (Grbl 1.1 protocol) at a TCP port of this computer, until Ctrl-C.
    Serve(Serve),
    /// Run the programs that come with the lathe, and show them on one page.
    Examples(Examples),
    /// Draw what each pulse method does on a line and on an arc, and every kind of curve: methods-line, methods-arc and
    /// curves in out/, SVG and PNG.
    CompareMethods,
    /// List all parameters with units, ranges and defaults.
    Parameters,
}

#[derive(Args, Default)]
struct Turn {
    /// Program text; `-` is standard input.
    file: Option<PathBuf>,
    /// How the program is written.
    #[arg(long, value_enum, default_value_t = FormatName::Auto)]
    format: FormatName,
    /// Machine parameters, in TOML.
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// One parameter; beats the machine file. `parameters` lists them.
    #[arg(long, value_name = "NAME=VALUE", value_parser = name_and_value)]
    set: Vec<(String, String)>,
    /// Tables of pitch errors for the control, a line a point: axis, position in mm, error in um.
    #[arg(long, value_name = "FILE.txt")]
    pitch_table: Option<PathBuf>,
    /// Write every step: time in ns, position in pulses.
    #[arg(long, value_name = "FILE.csv")]
    trace: Option<PathBuf>,
    /// Write the figures.
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// Draw the path (SVG or PNG by the name's ending). Without any output option out/NAME.svg and .png are drawn.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    picture: Option<PathBuf>,
    /// Draw how far the cut surface is from the contour, magnified.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    error_picture: Option<PathBuf>,
    /// Draw speed, acceleration and pulse rate over time.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    motion_picture: Option<PathBuf>,
    /// Show the cut, as an animated picture.
    #[arg(long, value_name = "FILE.gif|png", value_parser = animation_file)]
    animate: Option<PathBuf>,
}

#[derive(Args)]
struct Operate {
    /// The script: a line an event, SECONDS WHAT.
    scenario: PathBuf,
    /// How the programs that it loads are written.
    #[arg(long, value_enum, default_value_t = FormatName::Auto)]
    format: FormatName,
    /// Machine parameters, in TOML.
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// One parameter; beats the machine file. `parameters` lists them.
    #[arg(long, value_name = "NAME=VALUE", value_parser = name_and_value)]
    set: Vec<(String, String)>,
    /// Tables of pitch errors for the control, a line a point: axis, position in mm, error in um.
    #[arg(long, value_name = "FILE.txt")]
    pitch_table: Option<PathBuf>,
    /// Write every step: time in ns, position in pulses.
    #[arg(long, value_name = "FILE.csv")]
    trace: Option<PathBuf>,
    /// Write the final state.
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// Draw what the tool did (SVG or PNG by the name's ending). Without any output option out/NAME.svg, .png and .csv are
    /// written.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    picture: Option<PathBuf>,
}

#[derive(Args)]
struct Soak {
    /// Simulated hours.
    #[arg(long, default_value_t = 1.0)]
    hours: f64,
    /// Where chance begins: the same seed gives the same sessions.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Run this scenario under the same rules, instead.
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    /// Where failures are written.
    #[arg(long, value_name = "FOLDER", default_value = "out/soak")]
    folder: PathBuf,
    /// Go on until so many failures were found.
    #[arg(long, default_value_t = 1)]
    failures: u64,
}

#[derive(Args)]
struct Serve {
    /// Port on this computer (127.0.0.1) only; 0 takes any that is free. The first line printed names it.
    #[arg(long, value_name = "PORT")]
    tcp: u16,
    /// Run as fast as the sender lets, not in real time; the pulses are the same.
    #[arg(long)]
    fast: bool,
    /// Machine parameters, in TOML.
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// One parameter; beats the machine file. `parameters` lists them.
    #[arg(long, value_name = "NAME=VALUE", value_parser = name_and_value)]
    set: Vec<(String, String)>,
}

#[derive(Args)]
struct Examples {
    /// Where the page goes.
    #[arg(long, value_name = "FILE.html", default_value = "out/examples.html")]
    page: PathBuf,
}

#[derive(Copy, Clone, Default, ValueEnum)]
enum FormatName {
    /// Told from the text.
    #[default]
    Auto,
    /// Word address (ISO 6983).
    Gcode,
    /// The sample of 1973: pulses of 0.01 mm, arcs by quadrants.
    Nc1973,
}

impl FormatName {
    const fn format(self) -> Option<Format> {
        match self {
            Self::Auto => None,
            Self::Gcode => Some(Format::Gcode),
            Self::Nc1973 => Some(Format::Nc1973),
        }
    }
}

fn name_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().into(), value.trim().into())),
        _ => Err("write it as NAME=VALUE".into()),
    }
}

fn picture_file(text: &str) -> Result<PathBuf, String> {
    ending_in(text, ["svg", "png"])
}

fn animation_file(text: &str) -> Result<PathBuf, String> {
    ending_in(text, ["gif", "png"])
}

fn ending_in(text: &str, endings: [&str; 2]) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    if endings.iter().any(|known| ending.as_deref() == Some(known.as_ref())) {
        return Ok(path);
    }
    let [a, b] = endings;
    Err(format!("the name must end in .{a} or .{b}"))
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli.command.unwrap_or_else(|| Command::Turn(Turn::default())) {
        Command::Turn(options) => ExitCode::from(turn::turn(&Job {
            file: options.file,
            format: options.format.format(),
            machine: options.machine,
            set: options.set,
            pitch_table: options.pitch_table,
            trace: options.trace,
            report: options.report,
            picture: options.picture,
            error_picture: options.error_picture,
            motion_picture: options.motion_picture,
            animate: options.animate,
        })),
        Command::Operate(options) => ExitCode::from(operate::operate(&operate::Job {
            scenario: options.scenario,
            format: options.format.format(),
            machine: options.machine,
            set: options.set,
            pitch_table: options.pitch_table,
            trace: options.trace,
            report: options.report,
            picture: options.picture,
        })),
        Command::Soak(options) => ExitCode::from(operate::soak::soak(&operate::soak::Job {
            hours: options.hours,
            seed: options.seed,
            replay: options.replay,
            folder: options.folder,
            failures: options.failures,
        })),
        Command::Serve(options) => ExitCode::from(serve::serve(&serve::Job {
            port: options.tcp,
            fast: options.fast,
            machine: options.machine,
            set: options.set,
        })),
        Command::Examples(options) => ExitCode::from(gallery::write(&options.page)),
        Command::CompareMethods => {
            let (folder, mut out) = (std::path::Path::new("out"), std::io::stdout().lock());
            let drawn = virtual_lathe::compare_methods::compare(folder, &mut out)
                .and_then(|()| virtual_lathe::compare_laws::compare(folder, &mut out));
            match drawn {
                Ok(()) => ExitCode::SUCCESS,
                Err(error) => {
                    let _ = writeln!(std::io::stderr(), "error: {error}");
                    ExitCode::FAILURE
                }
            }
        }
        Command::Parameters => {
            // a reader that has gone is no failure
            let _ = std::io::stdout().lock().write_all(virtual_lathe::report::parameters().as_bytes());
            ExitCode::SUCCESS
        }
    }
}
