//! QEMU: the emulated chip, its serial port and its log.

use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};

use crate::toolchain::apt;

/// The emulator.
pub(crate) const QEMU: &str = "qemu-system-arm";

/// Finds the emulator; as root on Debian it is installed.
pub(crate) fn find() -> Result<()> {
    let runs = || Command::new(QEMU).arg("--version").output().is_ok_and(|output| output.status.success());
    if runs() {
        return Ok(());
    }
    let remedy = "QEMU for ARM is missing: apt-get install qemu-system-arm";
    if !Path::new("/usr/bin/apt-get").exists() {
        bail!(remedy);
    }
    apt(&["qemu-system-arm"]).context(remedy)
}

/// A running emulator. It ends with this value.
pub(crate) struct Machine {
    child: Child,
    monitor: Option<ChildStdin>,
    serial: UnixStream,
    _folder: tempfile::TempDir,
}

impl Drop for Machine {
    fn drop(&mut self) {
        // it may have ended by itself; either way it is gone afterwards
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Quotes a word for one of QEMU's option lists.
fn quoted(word: &str) -> String {
    word.replace(',', ",,")
}

impl Machine {
    /// Starts `elf` with these words on its command line. One emulated instruction takes 8 ns; emulated time passes
    /// only as instructions are executed, and skips what the machine sleeps.
    pub(crate) fn start(elf: &Path, words: &[String], more: &[String]) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let path: PathBuf = folder.path().join("serial");
        let listener = UnixListener::bind(&path)?;
        let mut semihosting = "enable=on,target=native,arg=firmware".to_owned();
        for word in words {
            semihosting.push_str(",arg=");
            semihosting.push_str(&quoted(word));
        }
        let mut command = Command::new(QEMU);
        command
            .args(["-M", "netduinoplus2", "-display", "none", "-monitor", "stdio", "-serial", "null", "-serial"])
            .arg(format!("unix:{}", quoted(&path.display().to_string())))
            .args(["-icount", "shift=3,sleep=off", "-semihosting-config", &semihosting, "-kernel"])
            .arg(elf)
            .args(more)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut child = command.spawn().context("starting QEMU")?;
        listener.set_nonblocking(true)?;
        let began = Instant::now();
        let serial = loop {
            match listener.accept() {
                Ok((serial, _)) => break serial,
                Err(_) if began.elapsed() > Duration::from_secs(60) => {
                    let _ = child.kill();
                    bail!("QEMU does not open its serial port");
                }
                Err(_) => {
                    if let Some(status) = child.try_wait()? {
                        let mut text = String::new();
                        if let Some(mut stderr) = child.stderr.take() {
                            stderr.read_to_string(&mut text)?;
                        }
                        bail!("QEMU ended with {status}: {}", text.trim());
                    }
                    std::thread::sleep(Duration::from_millis(2));
                }
            }
        };
        serial.set_nonblocking(false)?;
        serial.set_read_timeout(Some(Duration::from_secs(120)))?;
        let monitor = child.stdin.take();
        Ok(Self { child, monitor, serial, _folder: folder })
    }

    /// Asks the emulator to end, and waits: a plugin then writes what it has.
    pub(crate) fn end(&mut self) {
        if let Some(mut monitor) = self.monitor.take() {
            let asked = monitor.write_all(b"quit\n").is_ok();
            let began = Instant::now();
            while asked && began.elapsed() < Duration::from_secs(10) && matches!(self.child.try_wait(), Ok(None)) {
                std::thread::sleep(Duration::from_millis(2));
            }
        }
    }

    /// The log, once.
    pub(crate) fn log(&mut self) -> Option<BufReader<ChildStderr>> {
        self.child.stderr.take().map(|stderr| BufReader::with_capacity(1 << 16, stderr))
    }

    /// The serial port.
    pub(crate) fn sender(&self) -> Result<Sender> {
        Ok(Sender {
            reader: BufReader::new(self.serial.try_clone()?),
            writer: self.serial.try_clone()?,
            under_way: Vec::new(),
            tolerant: false,
        })
    }
}

/// Bytes that the image's receive queue holds.
const WINDOW: usize = 255;

/// Streams lines to the link, counting the characters that are under way.
pub(crate) struct Sender {
    reader: BufReader<UnixStream>,
    writer: UnixStream,
    /// Length and number of each line that was not answered yet, oldest first.
    under_way: Vec<(usize, u32)>,
    /// A line may be refused.
    tolerant: bool,
}

impl Sender {
    /// One line from the image, without its end.
    fn line(&mut self) -> Result<String> {
        let mut line = Vec::new();
        if self.reader.read_until(b'\n', &mut line).context("the image says nothing")? == 0 {
            bail!("the image has closed the link");
        }
        Ok(String::from_utf8_lossy(&line).trim().to_owned())
    }

    /// Waits for the banner.
    pub(crate) fn banner(&mut self) -> Result<()> {
        while !self.line()?.starts_with("Grbl") {}
        Ok(())
    }

    /// Waits for one answer.
    fn answer(&mut self) -> Result<()> {
        loop {
            let line = self.line()?;
            let number = self.under_way.first().map_or(0, |(_, number)| *number);
            if line == "ok" || self.tolerant && line.starts_with("error") {
                self.under_way.remove(0);
                return Ok(());
            }
            if line.starts_with("error") || line.starts_with("ALARM") {
                bail!("the image answers line {number} with `{line}`");
            }
        }
    }

    /// Sends a command that is refused until the machine is seen idle, which it is some ticks after power-on.
    pub(crate) fn set(&mut self, command: &str) -> Result<()> {
        for _ in 0..1000 {
            self.writer.write_all(format!("{command}\n").as_bytes())?;
            loop {
                match &*self.line()? {
                    "ok" => return Ok(()),
                    "error:8" => break,
                    refused if refused.starts_with("error") => bail!("the image answers {command} with `{refused}`"),
                    _ => {}
                }
            }
        }
        bail!("the image is never idle for {command}")
    }

    /// Sends a line as soon as it fits.
    pub(crate) fn send(&mut self, number: u32, line: &[u8]) -> Result<()> {
        let length = line.len() + 1;
        if length > WINDOW {
            bail!("line {number} is longer than the image's queue");
        }
        while self.under_way.iter().map(|(length, _)| length).sum::<usize>() + length > WINDOW {
            self.answer()?;
        }
        self.writer.write_all(&[line, b"\n"].concat())?;
        self.under_way.push((length, number));
        Ok(())
    }

    /// Goes on behind lines that are refused.
    pub(crate) const fn tolerate(&mut self) {
        self.tolerant = true;
    }

    /// Sends a byte that acts at once.
    pub(crate) fn realtime(&mut self, byte: u8) -> Result<()> {
        Ok(self.writer.write_all(&[byte])?)
    }

    /// Waits until every line is answered.
    pub(crate) fn settle(&mut self) -> Result<()> {
        while !self.under_way.is_empty() {
            self.answer()?;
        }
        Ok(())
    }
}
