//! The command `serve`, as a sender sees it.
#![allow(clippy::unwrap_used, reason = "helpers of tests, which may panic")]

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Lines, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

/// A lathe that serves, ended with the test.
struct Lathe {
    process: Child,
    told: Lines<BufReader<ChildStdout>>,
    address: String,
}

impl Lathe {
    fn start(options: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_virtual-lathe"))
            .args(["serve", "--tcp", "0"])
            .args(options)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut told = BufReader::new(process.stdout.take().unwrap()).lines();
        let first = told.next().unwrap().unwrap();
        let address = first.strip_prefix("listening on ").unwrap().to_owned();
        Self { process, told, address }
    }

    fn connect(&self) -> Sender {
        let stream = TcpStream::connect(&self.address).unwrap();
        // no lathe takes that long: only to end a test that would hang
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let lines = BufReader::new(stream.try_clone().unwrap()).lines();
        Sender { stream, lines }
    }

    /// The next line that it prints.
    fn told(&mut self) -> String {
        self.told.next().unwrap().unwrap()
    }
}

impl Drop for Lathe {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

struct Sender {
    stream: TcpStream,
    lines: Lines<BufReader<TcpStream>>,
}

impl Sender {
    fn send(&mut self, bytes: impl AsRef<[u8]>) {
        self.stream.write_all(bytes.as_ref()).unwrap();
    }

    fn line(&mut self) -> String {
        self.lines.next().unwrap().unwrap()
    }

    /// The banner, as senders wait for it.
    fn greeted(mut self) -> Self {
        assert_eq!((self.line(), self.line()), (String::new(), "Grbl 1.1h ['$' for help]".into()));
        self
    }

    /// Streams a program counting characters; the answers.
    fn stream(&mut self, program: &[u8]) -> Vec<String> {
        let mut in_flight = VecDeque::new();
        let mut answers = Vec::new();
        for line in program.split_inclusive(|byte| *byte == b'\n') {
            while in_flight.iter().sum::<usize>() + line.len() > 127 {
                answers.push(self.line());
                in_flight.pop_front();
            }
            self.send(line);
            in_flight.push_back(line.len());
        }
        answers.extend(in_flight.iter().map(|_| self.line()));
        answers
    }
}

#[test]
fn the_demo_over_tcp_is_the_demo_turned() {
    let mut lathe = Lathe::start(&["--fast"]);
    let mut sender = lathe.connect().greeted();
    let answers = sender.stream(virtual_lathe::DEMO);
    assert!(answers.iter().all(|answer| answer == "ok"), "{answers:?}");
    assert!(lathe.told().ends_with(" s, 168618 pulses of X, 403304 of Z, train 37387de01abbc410"));
    // and again, on the same line; the closing % of the first was answered, too
    sender.send("G0 X0 Z0\nM30\n");
    assert_eq!((sender.line(), sender.line()), ("ok".into(), "ok".into()));
    assert!(lathe.told().starts_with("cycle 2: "));
    sender.stream(virtual_lathe::DEMO);
    assert!(lathe.told().ends_with("train 37387de01abbc410"));
}

#[test]
fn a_long_program_of_short_blocks_does_not_run_dry_in_a_hurry() {
    let mut lathe = Lathe::start(&["--fast"]);
    let mut program = String::from("G91 F1000\n");
    for at in 0..500 {
        program += ["G1 X0.02 Z-0.05\n", "G1 X-0.02 Z-0.05\n"][at % 2];
    }
    program += "M30\n";
    lathe.connect().greeted().stream(program.as_bytes());
    let cycle = lathe.told();
    let slow = virtual_lathe_train(&program);
    assert!(cycle.ends_with(&slow), "{cycle}, not {slow}");
}

/// The train that the command `turn` reports.
fn virtual_lathe_train(program: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let (text, report) = (folder.path().join("program.nc"), folder.path().join("report.json"));
    std::fs::write(&text, program).unwrap();
    let turn = Command::new(env!("CARGO_BIN_EXE_virtual-lathe"))
        .arg("turn")
        .args([&text, std::path::Path::new("--report"), &report])
        .stdout(Stdio::null())
        .status()
        .unwrap();
    assert!(turn.success());
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    format!("train {}", report.get("train_hash").unwrap().as_str().unwrap())
}

#[test]
fn a_sender_that_leaves_stops_nothing_and_the_next_one_is_let_in() {
    let mut lathe = Lathe::start(&["--fast", "--set", "start=10,0"]);
    let mut first = lathe.connect().greeted();
    first.send("G1 X12 Z-3 F200\nM30\nG0 X");
    assert_eq!((first.line(), first.line()), ("ok".into(), "ok".into()));
    // one at a time
    let mut refused = String::new();
    lathe.connect().stream.read_to_string(&mut refused).unwrap();
    assert_eq!(refused, "[MSG:another sender is connected]\r\n");
    drop(first);
    assert!(lathe.told().contains("1600 pulses of X, 1200 of Z"));
    let mut second = loop {
        // until the lathe has noticed that the first is gone
        let mut second = lathe.connect();
        if second.line().is_empty() {
            break second;
        }
    };
    second.line();
    second.send("?");
    assert!(second.line().starts_with("<Idle|MPos:12.000,0.000,-3.000|"));
    // half a line of the first sender is not continued
    second.send("Z5\n");
    assert!(second.line().contains("Z5 before any motion code"));
    assert_eq!(second.line(), "error:31");
}

#[test]
fn in_real_time_a_hold_and_a_reset_act_at_once() {
    let lathe = Lathe::start(&[]);
    let mut sender = lathe.connect().greeted();
    sender.send("G1 Z-2000 F3000\n");
    assert_eq!(sender.line(), "ok");
    let status = |sender: &mut Sender, wanted: &str| {
        loop {
            sender.send("?");
            let line = sender.line();
            if line.starts_with(wanted) {
                return line;
            }
        }
    };
    status(&mut sender, "<Run|MPos:0.000,0.000,-");
    sender.send("!");
    let held = status(&mut sender, "<Hold:0");
    sender.send(b"\x18");
    assert_eq!((sender.line(), sender.line()), (String::new(), "Grbl 1.1h ['$' for help]".into()));
    let place = |line: &str| line.split('|').nth(1).unwrap().to_owned();
    assert_eq!(place(&status(&mut sender, "<Idle")), place(&held));
}

#[test]
fn only_this_computer_is_served() {
    let lathe = Lathe::start(&[]);
    assert!(lathe.address.starts_with("127.0.0.1:"));
    let port = lathe.address.rsplit(':').next().unwrap();
    let second = Command::new(env!("CARGO_BIN_EXE_virtual-lathe")).args(["serve", "--tcp", port]).output().unwrap();
    assert_eq!(second.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&second.stderr).starts_with(&format!("error: port {port}: ")));
}
