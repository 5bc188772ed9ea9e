#![cfg_attr(target_os = "none", no_std, no_main)]
//! Links only if no panic can be reached from the foreground, the compile job and the link.

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod image {
    use core::convert::Infallible;
    use core::fmt;
    use core::hint::black_box;

    use handcnc::background::inbox::Inbox;
    use handcnc::background::keys::Pressed;
    use handcnc::background::link::{Link, Realtime};
    use handcnc::background::parameters::Parameters;
    use handcnc::background::status::Status;
    use handcnc::foreground::alarm::{Alarm, Faults};
    use handcnc::foreground::heartbeat::Heartbeat;
    use handcnc::foreground::inputs::Inputs;
    use handcnc::foreground::panel::{Contact, Panel, Turned, Wiring};
    use handcnc::foreground::rehearsal::Rehearsal;
    use handcnc::foreground::train_queue::TrainQueue;
    use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
    use handcnc::queue::Queue;
    use interp_core::block::Block;
    use interp_core::units::Lattice;

    #[panic_handler]
    #[inline(never)]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        #[allow(unsafe_code, reason = "a function that does not exist, so that the linker tells")]
        unsafe extern "C" {
            fn a_panic_can_be_reached() -> !;
        }
        // SAFETY: never linked, so never called.
        #[allow(unsafe_code, reason = "see above")]
        unsafe {
            a_panic_can_be_reached()
        }
    }

    struct Out;

    impl fmt::Write for Out {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            black_box(text);
            black_box(Ok::<(), Infallible>(())).map_err(|_| fmt::Error)
        }
    }

    #[allow(unsafe_code, reason = "the linker looks for this name")]
    #[unsafe(no_mangle)]
    extern "C" fn entry() -> ! {
        let mut parameters = black_box(Parameters::new());
        let set = parameters.set(black_box("x.pulse_nm"), black_box("1250"));
        black_box(set.is_ok());
        let Ok(machine) = parameters.machine() else { loop {} };
        let (mut blocks, mut commands) = (Queue::<Block, BLOCK_QUEUE>::new(), Queue::<Command, COMMAND_QUEUE>::new());
        let (mut bytes, mut realtime) = (Queue::<u8, 64>::new(), Queue::<Realtime, 16>::new());
        let (mut blocks_in, blocks_out) = blocks.split();
        let (mut commands_in, commands_out) = commands.split();
        let (bytes_in, mut bytes_out) = bytes.split();
        let (realtime_in, mut realtime_out) = realtime.split();
        let position = Lattice { x: black_box(0), z: black_box(0) };
        let mut memory = Memory::new();
        let mut foreground = Foreground::new(&machine, position, blocks_out, commands_out, &mut memory);
        let mut link = Link::new(parameters, machine);
        link.banner(&mut Out);
        let status = Status::new();
        let mut rehearsal = Rehearsal::new();
        black_box(rehearsal.set_word(black_box("7:hold")));
        let mut queue = TrainQueue::new();
        let (mut train, mut player) = queue.split();
        foreground.raise(black_box(Alarm::Watchdog));
        let mut heartbeat = Heartbeat::new();
        let wiring = Contact::ALL.into_iter().fold(Wiring::NONE, |wiring, contact| wiring.with(contact, black_box(1)));
        let (mut panel, pressed) = (Panel::new(wiring), Pressed::new());
        let mut inbox = Inbox::new(bytes_in, realtime_in);
        loop {
            inbox.take(black_box(0));
            while let Some(byte) = bytes_out.dequeue() {
                link.receive(byte);
            }
            while let Some(what) = realtime_out.dequeue() {
                link.realtime(what, &mut commands_in, &status.snapshot(), &mut Out);
            }
            black_box(link.work(&mut blocks_in, &mut commands_in, &status.snapshot(), &mut Out));
            let faults = Faults { underruns: train.underruns(), overruns: train.overruns(), late: black_box(0) };
            foreground.watch(faults, black_box(false));
            rehearsal.due(foreground.state(), &mut |act| foreground.act(act));
            foreground.read(&black_box(Inputs::NONE));
            pressed.mark(panel.serve(black_box(0), &black_box(Turned::default()), &mut foreground));
            black_box((pressed.take(), panel.asks()));
            black_box((foreground.shown(), foreground.refused(), foreground.kept()));
            let report = foreground.tick(&mut train);
            train.publish();
            black_box((foreground.outputs(), heartbeat.beat(black_box(true), report.speed)));
            status.publish(&report, &foreground, faults);
            black_box(player.next_or_idle(|| black_box(())));
            if cfg!(feature = "planted") {
                let places = black_box([1, 2, 3]);
                #[allow(clippy::indexing_slicing, reason = "planted")]
                black_box(places[black_box(3_usize)]);
            }
        }
    }
}
