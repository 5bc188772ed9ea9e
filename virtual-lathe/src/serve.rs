//! The command `serve`: the firmware's link and foreground behind a TCP port.
//!
//! One thread does what the chip's interrupts and tasks do: takes bytes, lets the background work, makes a tick a
//! millisecond. The lathe runs whether or not a client is there; a client that is lost, or does not read what it is
//! told, never stops it.
//!
//! With `--fast` ticks of a running cycle are not paced by the clock. Time then waits for the sender, or a program would
//! run dry that a real lathe is fed in time: while the queue has room a tick is made only when the sender is silent.
//! The train is the same.
//!
//! Standard output gets `listening on ADDRESS`, then a line for each cycle with its time and train.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use handcnc::background::link::{Link, Snapshot, realtime};
use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
use handcnc::queue::{Producer, Queue};
use interp_core::block::Block;
use interp_core::channel::{Report, State};
use interp_core::config::Machine;
use interp_core::train::{Event, Hash, Levels};
use interp_core::units::{Axis, Lattice};

use crate::options::Setup;
use crate::settings::Settings;
use crate::spindle::Turning;
use crate::turn;

/// One tick.
const TICK: Duration = Duration::from_millis(1);
/// Ticks that are late by more are not made up for: the computer slept.
const LATE: Duration = Duration::from_millis(100);
/// With `--fast`: how long a sender may be silent before its program goes on without more of it.
const SILENCE: Duration = Duration::from_millis(50);
/// With `--fast`: how long to wait before looking for bytes again.
const POLL: Duration = Duration::from_micros(50);
/// Bytes that a client may leave unread before it is dropped.
const UNREAD: usize = 1 << 20;

/// What `serve` is asked to do.
#[derive(Args, Clone, Debug, Default)]
pub struct Job {
    /// Port on this computer (127.0.0.1) only; 0 takes any that is free. The first line printed names it.
    #[arg(long = "tcp", value_name = "PORT")]
    pub port: u16,
    /// Run as fast as the sender lets, not in real time; the pulses are the same.
    #[arg(long)]
    pub fast: bool,
    /// The machine.
    #[command(flatten)]
    pub setup: Setup,
}

/// Serves until the process is ended; the exit code when it can't.
pub fn serve(job: &Job) -> u8 {
    let (settings, machine) = match turn::settings(&job.setup) {
        Ok(settings) => settings,
        Err(code) => return code,
    };
    let result = TcpListener::bind((Ipv4Addr::LOCALHOST, job.port)).and_then(|listener| {
        listener.set_nonblocking(true)?;
        tell(format_args!("listening on {}", listener.local_addr()?));
        run(&listener, job.fast, settings, &machine)
    });
    match result {
        Ok(()) => turn::DONE,
        Err(error) => {
            eprintln!("error: port {}: {error}", job.port);
            turn::UNUSABLE
        }
    }
}

/// Prints a line. Nobody may be reading, and the lathe goes on.
fn tell(text: std::fmt::Arguments<'_>) {
    let mut out = io::stdout().lock();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}

fn run(listener: &TcpListener, fast: bool, settings: Settings, machine: &Machine) -> io::Result<()> {
    let Settings { parameters, figures, .. } = settings;
    let mut turning = Turning::new(&figures).map_err(|error| io::Error::other(error.to_string()))?;
    let mut blocks = Queue::<Block, BLOCK_QUEUE>::new();
    let mut commands = Queue::<Command, COMMAND_QUEUE>::new();
    let (blocks, block_out) = blocks.split();
    let (commands, command_out) = commands.split();
    let start = parameters.start();
    let position = Lattice { x: machine.x.pulse.nearest(start.x), z: machine.z.pulse.nearest(start.z) };
    let mut memory = Memory::new();
    let mut foreground = Foreground::new(machine, position, block_out, command_out, &mut memory);
    let snapshot = Snapshot::at(position);
    let link = Link::new(parameters, *machine);
    let mut background = Background { link, blocks, commands, snapshot, client: None, heard: Instant::now() };
    let mut cycle = Cycle::new();
    let mut due = Instant::now();
    loop {
        background.attend(listener)?;
        let now = Instant::now();
        if fast && background.runs() {
            if background.wants_more(now) {
                thread::sleep(POLL);
                continue;
            }
            due = now;
        } else if due > now {
            // real-time bytes need not wait for the tick
            thread::sleep((due - now).min(TICK / 4));
            continue;
        } else if now - due > LATE {
            due = now;
        }
        due += TICK;
        foreground.read(&turning.read());
        let report = foreground.tick(&mut |event: Event| cycle.event(event));
        turning.tick(&report, foreground.alarm());
        cycle.tick(&report);
        // nothing plays the train here, so nothing finds it empty
        background.snapshot = Snapshot::of(&report, &foreground);
    }
}

/// The link with its queues and its client.
struct Background<'q> {
    link: Link,
    blocks: Producer<'q, Block>,
    commands: Producer<'q, Command>,
    snapshot: Snapshot,
    client: Option<Client>,
    /// When the last byte of a line came.
    heard: Instant,
}

impl Background<'_> {
    /// Takes what came, answers what is due.
    fn attend(&mut self, listener: &TcpListener) -> io::Result<()> {
        self.accept(listener)?;
        let Self { link, blocks, commands, snapshot, client, heard } = self;
        // without a client the answers to its last lines go nowhere
        let mut nowhere = Unsent::default();
        if let Some(client) = client {
            let mut bytes = [0; 256];
            let count = client.read(&mut bytes);
            for &byte in bytes.iter().take(count) {
                match realtime(byte) {
                    Some(what) => link.realtime(what, commands, snapshot, &mut client.unsent),
                    None => {
                        link.receive(byte);
                        *heard = Instant::now();
                    }
                }
            }
        }
        let out = client.as_mut().map_or(&mut nowhere, |client| &mut client.unsent);
        while link.work(blocks, commands, snapshot, out) {}
        if let Some(client) = client {
            client.write();
        }
        if let Some(client) = self.client.take_if(|client| client.gone) {
            client.close();
            self.link.disconnected();
        }
        Ok(())
    }

    /// Lets a client in where there is none, and turns others away.
    fn accept(&mut self, listener: &TcpListener) -> io::Result<()> {
        let mut stream = match listener.accept() {
            Ok((stream, _)) => stream,
            Err(error) if is_passing(&error) => return Ok(()),
            Err(error) => return Err(error),
        };
        if self.client.is_some() {
            // whether it hears why is up to it
            let _ = stream.write_all(b"[MSG:another sender is connected]\r\n");
            let _ = stream.shutdown(Shutdown::Both);
            return Ok(());
        }
        // answers are short and should not wait for more; without it they are only slower
        let _ = stream.set_nodelay(true);
        if stream.set_nonblocking(true).is_ok() {
            let mut client = Client { stream, unsent: Unsent::default(), gone: false };
            self.link.banner(&mut client.unsent);
            self.client = Some(client);
        }
        Ok(())
    }

    /// Whether a cycle moves on by itself.
    const fn runs(&self) -> bool {
        matches!(self.snapshot.state, State::Running | State::Resetting)
    }

    /// Whether more of the program may be on its way and would find room.
    fn wants_more(&self, now: Instant) -> bool {
        self.blocks.ready() && self.commands.is_empty() && now - self.heard < SILENCE
    }
}

/// Whether an error of the port is no reason to stop: nobody is there, or whoever was there left at once.
fn is_passing(error: &io::Error) -> bool {
    use ErrorKind::{ConnectionAborted, ConnectionReset, Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | Interrupted | ConnectionAborted | ConnectionReset | TimedOut)
}

/// What a client is still to be told.
#[derive(Default)]
struct Unsent(Vec<u8>);

impl std::fmt::Write for Unsent {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.0.extend_from_slice(text.as_bytes());
        Ok(())
    }
}

/// A sender.
struct Client {
    stream: TcpStream,
    unsent: Unsent,
    gone: bool,
}

impl Client {
    /// Bytes that came.
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        match self.stream.read(bytes) {
            Ok(0) => {
                self.gone = true;
                0
            }
            Ok(count) => count,
            Err(error) => {
                self.gone |= !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted);
                0
            }
        }
    }

    /// Sends as much as the wire takes.
    fn write(&mut self) {
        while !self.gone && !self.unsent.0.is_empty() {
            match self.stream.write(&self.unsent.0) {
                Ok(0) => self.gone = true,
                Ok(count) => drop(self.unsent.0.drain(..count)),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => self.gone = true,
            }
        }
        self.gone |= self.unsent.0.len() > UNREAD;
    }

    /// Says goodbye; the other side may be gone already.
    fn close(self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }
}

/// The cycle that runs, or the last one.
struct Cycle {
    open: bool,
    count: u64,
    /// Events of the present tick.
    events: Vec<Event>,
    levels: Levels,
    hash: Hash,
    ticks: u64,
    /// Up to the last tick that moved.
    moved: (Hash, u64),
    pulses: [u64; 2],
}

impl Cycle {
    const fn new() -> Self {
        let hash = Hash::new();
        Self {
            open: false,
            count: 0,
            events: Vec::new(),
            levels: Levels::LOW,
            hash,
            ticks: 0,
            moved: (hash, 0),
            pulses: [0; 2],
        }
    }

    fn event(&mut self, event: Event) {
        self.events.push(event);
    }

    /// Ends a tick: counts it, where it belongs to a cycle, and tells of a cycle that is over.
    fn tick(&mut self, report: &Report) {
        if report.in_cycle && !self.open {
            let events = std::mem::take(&mut self.events);
            *self = Self { open: true, count: self.count + 1, events, levels: self.levels, ..Self::new() };
        }
        let mut moves = false;
        for event in self.events.drain(..) {
            let (now, before) = (event.levels(), self.levels);
            let rises = [Axis::X, Axis::Z].map(|axis| now.step(axis) && !before.step(axis));
            self.levels = now;
            if self.open && report.in_cycle {
                self.hash.event(event);
            }
            for (pulses, rises) in self.pulses.iter_mut().zip(rises) {
                *pulses += u64::from(rises);
                moves |= rises;
            }
        }
        self.ticks += u64::from(report.in_cycle);
        if moves {
            self.moved = (self.hash, self.ticks);
        }
        if self.open && matches!(report.state, State::Ended | State::Idle) {
            self.open = false;
            let (hash, ticks) = self.moved;
            let [x, z] = self.pulses;
            let (count, train) = (self.count, hash.value());
            let (seconds, part) = (ticks / 1000, ticks % 1000);
            tell(format_args!("cycle {count}: {seconds}.{part:03} s, {x} pulses of X, {z} of Z, train {train:016x}"));
        }
    }
}
