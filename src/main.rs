#![cfg_attr(target_os = "none", no_std, no_main)]
//! The firmware: the RTIC app and nothing else.
//!
//! What the tasks do stands in the library, where desktop tests reach it; what a register is stands in `board`.
//! On the desktop this is an empty program.

#[cfg(target_os = "none")]
mod board;

#[cfg(not(target_os = "none"))]
fn main() {}

/// What runs when. A task preempts all of lower priority; a test compares this table with the attributes.
///
/// | prio | task          | trigger                         | shared | does                                        |
/// |------|---------------|---------------------------------|--------|---------------------------------------------|
/// | 5    | `emergency`   | EXTI15_10                       | none   | drivers off, spindle off, train stopped     |
/// | 4    | `pulse`       | TIM5                            | none   | plays an event or a pulse of the train      |
/// | 3    | `interpolate` | I2C3_ER, pended by `pulse`      | none   | makes the tick after the one being played   |
/// | 2    | `receive`     | USART2                          | none   | bytes and real-time commands into queues    |
/// | 1    | `edit`        | I2C3_EV, pended by both above   | none   | the link: replies, compiles, fills the queue |
/// | 0    | `idle`        | nothing else to do              | none   | sleeps                                      |
///
/// Between the tasks stand single-producer queues and published words, never a lock. `edit` is no asynchronous task: the
/// state machine of an `async fn` keeps a panic reachable ("resumed after completion") that nothing proves away. Pended
/// while it runs, it runs once more.
#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use core::mem::MaybeUninit;
    use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

    use handcnc::background::inbox::{Inbox, LOST};
    use handcnc::background::keeper::Keeper;
    use handcnc::background::keys::Pressed;
    use handcnc::background::link::{Link, Realtime};
    use handcnc::background::status::Status;
    use handcnc::foreground::alarm::{Alarm, Faults};
    use handcnc::foreground::heartbeat::Heartbeat;
    use handcnc::foreground::kept::Record;
    use handcnc::foreground::train_queue::{Player, TrainQueue, Writer};
    use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
    use handcnc::queue::{Consumer, Producer, Queue};
    use interp_core::block::Block;
    use interp_core::units::Lattice;
    use stm32f4xx_hal::pac::Interrupt;

    use crate::board::{
        self, Bench, Board, Contact, Controls, Drives, EmergencyInput, Fall, Memory as Backup, Receiver, Sender,
        StepPort, StepTimer, Teller, Watchdog, Width,
    };

    /// Bytes on their way to the link: what a sender may have under way.
    const BYTES: usize = 256;
    /// Real-time commands on their way to the link.
    const REALTIME: usize = 32;

    static STATUS: Status = Status::new();
    static RECORD: Record = Record::new();
    static LATE: AtomicU32 = AtomicU32::new(0);
    static HUNGRY: AtomicBool = AtomicBool::new(true);
    static PRESSED: Pressed = Pressed::new();
    /// The emergency input has opened since the last tick.
    static STRUCK: AtomicBool = AtomicBool::new(false);
    /// The background has run since the last tick.
    static ALIVE: AtomicBool = AtomicBool::new(true);

    /// What `pulse` needs, side by side, so that few instructions find it.
    struct Steps {
        player: Player<'static>,
        timer: StepTimer,
        port: StepPort,
        fall: Fall,
    }

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        emergency: EmergencyInput,
        switch: Drives,
        steps: Steps,
        foreground: &'static mut Foreground<'static>,
        train: Writer<'static>,
        width: Width,
        contact: Contact,
        controls: Controls,
        drives: Drives,
        watchdog: Watchdog,
        heartbeat: Heartbeat,
        keeper: Keeper,
        backup: Backup,
        bench: Bench,
        receiver: Receiver,
        inbox: Inbox<'static>,
        link: &'static mut Link,
        sender: Sender,
        bytes: Consumer<'static, u8>,
        realtime: Consumer<'static, Realtime>,
        blocks: Producer<'static, Block>,
        commands: Producer<'static, Command>,
    }

    #[init(local = [
        train_queue: TrainQueue = TrainQueue::new(),
        bytes_queue: Queue<u8, BYTES> = Queue::new(),
        realtime_queue: Queue<Realtime, REALTIME> = Queue::new(),
        blocks_queue: Queue<Block, BLOCK_QUEUE> = Queue::new(),
        commands_queue: Queue<Command, COMMAND_QUEUE> = Queue::new(),
        // the largest are made where they stay: on the way through the stack they would be there three times
        memory: Memory = Memory::new(),
        foreground_place: MaybeUninit<Foreground<'static>> = MaybeUninit::uninit(),
        link_place: MaybeUninit<Link> = MaybeUninit::uninit(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let have = board::setup(cx.device);
        let Board { parameters, mut sender, drives, mut timer, .. } = have;
        let Ok(machine) = parameters.machine() else { board::safe() };
        let (train, player) = cx.local.train_queue.split();
        let (bytes_in, bytes) = cx.local.bytes_queue.split();
        let (realtime_in, realtime) = cx.local.realtime_queue.split();
        let (blocks, blocks_out) = cx.local.blocks_queue.split();
        let (commands, commands_out) = cx.local.commands_queue.split();
        let start = parameters.start();
        let position = Lattice { x: machine.x.pulse.nearest(start.x), z: machine.z.pulse.nearest(start.z) };
        let memory = cx.local.memory;
        let new = || Foreground::new(&machine, position, blocks_out, commands_out, memory);
        let foreground = make(cx.local.foreground_place, new);
        foreground.obey(Command::FeedOverride(parameters.feed_override()));
        foreground.obey(Command::Settle(parameters.operation(&machine)));
        let (keeper, found) = Keeper::new(&machine, &have.backup);
        if let Some(found) = found {
            foreground.restore(&found);
        }
        defmt::println!("{=str}, restarted by the watchdog: {=bool}", env!("CARGO_PKG_VERSION"), have.restarted);
        if have.restarted {
            foreground.raise(Alarm::Watchdog);
        }
        if Backup::DOUBTFUL {
            foreground.raise(Alarm::PowerReturned);
        }
        let link = make(cx.local.link_place, || Link::new(parameters, machine));
        link.banner(&mut sender);
        rtic::pend(Interrupt::I2C3_ER); // the first tick, played while the second is made
        timer.start(); // the banner alone takes more than a tick
        let inbox = Inbox::new(bytes_in, realtime_in);
        (
            Shared {},
            Local {
                emergency: have.emergency,
                switch: drives,
                steps: Steps { player, timer, port: have.port, fall: have.fall },
                foreground,
                train,
                width: have.width,
                contact: have.contact,
                controls: have.controls,
                drives,
                watchdog: have.watchdog,
                heartbeat: Heartbeat::new(),
                keeper,
                backup: have.backup,
                bench: have.bench,
                receiver: have.receiver,
                inbox,
                link,
                sender,
                bytes,
                realtime,
                blocks,
                commands,
            },
        )
    }

    /// Whether a mark was set, and takes it away. Only one task takes a mark, and a mark set once more in between is the
    /// same mark; so nothing is exchanged at once, which costs more.
    #[inline]
    fn taken(mark: &AtomicBool) -> bool {
        let set = mark.load(Relaxed);
        if set {
            mark.store(false, Relaxed);
        }
        set
    }

    /// Makes something large where it stays. Out of line, so that what passes over the stack is there for the call only.
    #[inline(never)]
    fn make<T>(place: &'static mut MaybeUninit<T>, new: impl FnOnce() -> T) -> &'static mut T {
        place.write(new())
    }

    /// Everything off, and no step leaves the chip; the next tick raises the alarm.
    #[task(binds = EXTI15_10, priority = 5, local = [emergency, switch])]
    fn emergency(cx: emergency::Context) {
        cx.local.switch.off();
        STRUCK.store(true, Relaxed);
        cx.local.emergency.acknowledge();
    }

    /// Plays an event of the train, or a pulse that falls by itself.
    #[task(binds = TIM5, priority = 4, local = [steps])]
    fn pulse(cx: pulse::Context) {
        let Steps { player, timer, port, fall } = cx.local.steps;
        timer.acknowledge();
        let play = player.next_or_idle(|| rtic::pend(Interrupt::I2C3_ER));
        port.write(play);
        if play.falls() {
            fall.start();
        }
        if timer.load(play.clocks()) {
            LATE.store(LATE.load(Relaxed).saturating_add(1), Relaxed);
        }
    }

    /// Makes the tick after the one being played.
    #[task(binds = I2C3_ER, priority = 3, local = [foreground, train, width, contact, controls, drives, watchdog, heartbeat, bench, since: u8 = 0])]
    fn interpolate(cx: interpolate::Context) {
        let interpolate::LocalResources {
            foreground,
            train,
            width,
            contact,
            controls,
            drives,
            watchdog,
            heartbeat,
            bench,
            since,
            ..
        } = cx.local;
        width.set(foreground.pulse_width()); // of the tick that is being played
        PRESSED.mark(controls.read(foreground));
        let faults = Faults { underruns: train.underruns(), overruns: train.overruns(), late: LATE.load(Relaxed) };
        foreground.watch(faults, taken(&STRUCK) || contact.is_open());
        bench.due(foreground.state(), &mut |act| foreground.act(act));
        let report = foreground.tick(train);
        train.publish();
        if !STRUCK.load(Relaxed) {
            drives.follow(foreground.outputs());
        }
        if STRUCK.load(Relaxed) {
            drives.off(); // the emergency task came between
        }
        if heartbeat.beat(taken(&ALIVE), report.speed) {
            watchdog.feed();
        }
        bench.saw(&report, faults);
        STATUS.publish(&report, foreground, faults);
        RECORD.publish(since, foreground);
        HUNGRY.store(foreground.is_hungry(), Relaxed);
        rtic::pend(Interrupt::I2C3_EV);
    }

    /// Sorts what the link receives.
    #[task(binds = USART2, priority = 2, local = [receiver, inbox])]
    fn receive(cx: receive::Context) {
        while let Some(byte) = cx.local.receiver.byte() {
            cx.local.inbox.take(byte);
        }
        rtic::pend(Interrupt::I2C3_EV);
    }

    /// Talks with the sender and compiles what it sends.
    #[task(binds = I2C3_EV, priority = 1, local = [link, sender, bytes, realtime, blocks, commands, keeper, backup, told: Option<Alarm> = None, teller: Teller = Teller::new()])]
    fn edit(cx: edit::Context) {
        let edit::LocalResources {
            link, sender, bytes, realtime, blocks, commands, keeper, backup, told, teller, ..
        } = cx.local;
        #[cfg(feature = "planted-panic")]
        board::plant();
        loop {
            ALIVE.store(true, Relaxed);
            while let Some(byte) = bytes.dequeue() {
                if byte == LOST { link.damaged() } else { link.receive(byte) }
            }
            while let Some(what) = realtime.dequeue().or_else(|| PRESSED.take()) {
                link.realtime(what, commands, &STATUS.snapshot(), sender);
            }
            if !link.work(blocks, commands, &STATUS.snapshot(), sender) {
                break;
            }
        }
        if let Some(kept) = RECORD.read() {
            keeper.keep(&kept, backup);
        }
        let alarm = STATUS.snapshot().alarm;
        if core::mem::replace(told, alarm) != alarm {
            defmt::error!("alarm {=u8}", alarm.map_or(0, Alarm::number));
        }
        teller.tell();
    }

    /// Sleeps.
    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            board::sleep(HUNGRY.load(Relaxed));
        }
    }
}
