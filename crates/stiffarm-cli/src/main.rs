//! The program `stiffarm`.

fn main() -> std::process::ExitCode {
    stiffarm_cli::run_process()
}
