//! The command line of the virtual lathe.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use virtual_lathe::{gallery, operate, serve, turn};

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
    Turn(Box<turn::Job>),
    /// Operate the lathe as a script says: wheels, joystick, modes, programs, switches; print its final state.
    Operate(operate::Job),
    /// Let random operators loose on random machines, and look that nothing they do breaks a rule; what fails is made short
    /// and written as a scenario.
    Soak(operate::soak::Job),
    /// Run the lathe for a sender of G-code (Grbl 1.1 protocol) at a TCP port of this computer, until Ctrl-C.
    Serve(serve::Job),
    /// Run the programs that come with the lathe, and show them on one page.
    Examples(Examples),
    /// Draw what each pulse method does on a line and on an arc, and every kind of curve: methods-line, methods-arc and
    /// curves in out/, SVG and PNG.
    CompareMethods,
    /// List all parameters with units, ranges and defaults.
    Parameters,
}

#[derive(Args)]
struct Examples {
    /// Where the page goes.
    #[arg(long, value_name = "FILE.html", default_value = "out/examples.html")]
    page: PathBuf,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli.command.unwrap_or_else(|| Command::Turn(Box::default())) {
        Command::Turn(job) => ExitCode::from(turn::turn(&job)),
        Command::Operate(job) => ExitCode::from(operate::operate(&job)),
        Command::Soak(job) => ExitCode::from(operate::soak::soak(&job)),
        Command::Serve(job) => ExitCode::from(serve::serve(&job)),
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
