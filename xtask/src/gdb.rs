//! A debugger at the emulated core: QEMU's stub speaks GDB's remote serial protocol.
//!
//! As long as this value lives the core stands but where it is told to go on; breakpoints go with it.
//!
//! Source: "Debugging with GDB", appendix E (packets `? p P M Z0 z0 c s D`).

use std::io::{BufReader, ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};

/// Numbers of registers in the stub's description of a core of this kind.
const PC: u32 = 15;
const XPSR: u32 = 25;

/// Bits of XPSR: the exception being handled, and the state of an IT block.
const EXCEPTION: u32 = 0x1FF;
const IT: u32 = 0x0600_FC00;

/// How long an answer may take.
const WAIT: Duration = Duration::from_secs(120);

/// A connection to the stub.
pub(crate) struct Debugger {
    reader: BufReader<UnixStream>,
    writer: UnixStream,
}

impl Debugger {
    /// Stops the core.
    pub(crate) fn attach(path: &Path) -> Result<Self> {
        let writer = UnixStream::connect(path).context("the emulator's debugger does not listen")?;
        writer.set_read_timeout(Some(WAIT))?;
        let mut debugger = Self { reader: BufReader::new(writer.try_clone()?), writer };
        debugger.ask("QStartNoAckMode")?;
        debugger.writer.write_all(b"+")?;
        debugger.ask("?")?;
        // single registers are given only to who has read what there are
        debugger.ask("qXfer:features:read:target.xml:0,1000")?;
        Ok(debugger)
    }

    /// Lets the core run, and leaves it.
    pub(crate) fn detach(mut self) -> Result<()> {
        self.ask("D").map(drop)
    }

    /// Sends a packet and takes the reply. That the core stops is told unasked when the debugger comes.
    fn ask(&mut self, packet: &str) -> Result<String> {
        let sum = packet.bytes().fold(0_u8, u8::wrapping_add);
        self.writer.write_all(format!("${packet}#{sum:02x}").as_bytes())?;
        loop {
            let reply = self.reply().with_context(|| format!("the debugger does not answer {packet}"))?;
            if reply.starts_with('E') {
                bail!("the debugger answers {packet} with {reply}");
            }
            if !reply.starts_with('T') || matches!(packet, "?" | "s") {
                return Ok(reply);
            }
        }
    }

    fn reply(&mut self) -> Result<String> {
        while self.byte()? != b'$' {}
        let mut reply = Vec::new();
        loop {
            match self.byte()? {
                b'#' => break,
                byte => reply.push(byte),
            }
        }
        self.byte()?;
        self.byte()?;
        Ok(String::from_utf8_lossy(&reply).into_owned())
    }

    fn byte(&mut self) -> std::io::Result<u8> {
        let mut byte = [0_u8];
        self.reader.read_exact(&mut byte)?;
        let [byte] = byte;
        Ok(byte)
    }

    fn register(&mut self, number: u32) -> Result<u32> {
        let text = self.ask(&format!("p{number:x}"))?;
        let word = u32::from_str_radix(&text, 16).with_context(|| format!("register {number} is `{text}`"))?;
        Ok(word.swap_bytes())
    }

    fn set_register(&mut self, number: u32, value: u32) -> Result<()> {
        self.ask(&format!("P{number:x}={:08x}", value.swap_bytes())).map(drop)
    }

    /// Where the core stands.
    pub(crate) fn place(&mut self) -> Result<u32> {
        self.register(PC)
    }

    /// The number of the exception that the core handles, 0 for none.
    pub(crate) fn exception(&mut self) -> Result<u32> {
        Ok(self.register(XPSR)? & EXCEPTION)
    }

    /// Lets the core go on at another place.
    pub(crate) fn jump(&mut self, place: u32) -> Result<()> {
        let state = self.register(XPSR)?;
        self.set_register(XPSR, state & !IT)?;
        self.set_register(PC, place)
    }

    /// Writes half a word, in flash, too.
    pub(crate) fn patch(&mut self, place: u32, half: u16) -> Result<()> {
        self.ask(&format!("M{place:x},2:{:04x}", half.swap_bytes())).map(drop)
    }

    /// Sets a breakpoint.
    pub(crate) fn break_at(&mut self, place: u32) -> Result<()> {
        self.ask(&format!("Z0,{place:x},2")).map(drop)
    }

    /// Takes a breakpoint away.
    pub(crate) fn pass(&mut self, place: u32) -> Result<()> {
        self.ask(&format!("z0,{place:x},2")).map(drop)
    }

    /// Goes on to the next breakpoint. False where none is met before `over` says so: the core runs then.
    pub(crate) fn go(&mut self, over: &dyn Fn() -> bool) -> Result<bool> {
        self.writer.write_all(b"$c#63")?;
        let began = Instant::now();
        self.writer.set_read_timeout(Some(Duration::from_millis(20)))?;
        let stopped = loop {
            match self.byte() {
                Ok(b'$') => break true,
                Err(error) if !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Err(error)?,
                Ok(_) => {}
                Err(_) if over() => break false,
                Err(_) if began.elapsed() > WAIT => bail!("the core neither goes on nor stops"),
                Err(_) => {}
            }
        };
        self.writer.set_read_timeout(Some(WAIT))?;
        while stopped && self.byte()? != b'#' {}
        if stopped {
            self.byte()?;
            self.byte()?;
        }
        Ok(stopped)
    }

    /// Executes one instruction; no interrupt is taken.
    pub(crate) fn step(&mut self) -> Result<()> {
        self.ask("s").map(drop)
    }
}
