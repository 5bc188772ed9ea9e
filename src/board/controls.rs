//! What a real board reads of its operator and its machine: encoders at timers, contacts at pins.
//!
//! X's wheel is at TIM2, Z's at TIM3, the contour wheel at TIM8 (the F411 has none), the spindle's encoder at TIM4 with its
//! index at channel 3. TIM5 and TIM1 are the train's. TIM9 and TIM12 have two channels and no encoder mode, so no timer is
//! left for a scale. The HAL's types of a timer's channels say at compile time which pins carry them; that a pin or a timer is
//! used twice is an error of ownership.
//!
//! Nothing interrupts: the interpolator reads the counters first of all, within a microsecond or two of a tick's start, and
//! the ports behind them.

use core::ops::Deref;
use core::sync::atomic::Ordering::Relaxed;

use handcnc::foreground::Foreground;
use handcnc::foreground::inputs::PerAxis;
use handcnc::foreground::panel::{Keys, Panel, Turned, Wiring};
use handcnc::foreground::published::Published;
use interp_core::drive::spindle::Reading;
use stm32f4xx_hal::gpio::alt::TimCPin;
use stm32f4xx_hal::gpio::{Pin, PinMode, PinPull, Pull, PushPull};
use stm32f4xx_hal::pac::tim3::RegisterBlock;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::pins::{Place, registers};
use super::quadrature::{self, Count, Filter, Port, Register};
use super::registers::Registers;
use super::this;

/// An encoder's timer.
pub(crate) struct Encoder(Registers<RegisterBlock>);

impl Port for Encoder {
    #[inline]
    fn write(&mut self, register: Register, value: u32) {
        let timer = &self.0;
        // SAFETY: the timer's only owner writes what the manual allows there (see `quadrature`); no write touches memory.
        #[allow(unsafe_code, reason = "registers by their values, which tests see")]
        unsafe {
            match register {
                Register::Cr1 => timer.cr1().write(|w| w.bits(value)),
                Register::Smcr => timer.smcr().write(|w| w.bits(value)),
                Register::Dier => timer.dier().write(|w| w.bits(value)),
                Register::Sr => timer.sr().write(|w| w.bits(value)),
                Register::Ccmr1 => timer.ccmr1_input().write(|w| w.bits(value)),
                Register::Ccmr2 => timer.ccmr2_input().write(|w| w.bits(value)),
                Register::Ccer => timer.ccer().write(|w| w.bits(value)),
                Register::Cnt => timer.cnt().write(|w| w.bits(value)),
                Register::Psc => timer.psc().write(|w| w.bits(value)),
                Register::Arr => timer.arr().write(|w| w.bits(value)),
                Register::Ccr3 => timer.ccr3().write(|w| w.bits(value)),
            }
        };
    }

    #[inline]
    fn read(&mut self, register: Register) -> u32 {
        let timer = &self.0;
        match register {
            Register::Cr1 => timer.cr1().read().bits(),
            Register::Smcr => timer.smcr().read().bits(),
            Register::Dier => timer.dier().read().bits(),
            Register::Sr => timer.sr().read().bits(),
            Register::Ccmr1 => timer.ccmr1_input().read().bits(),
            Register::Ccmr2 => timer.ccmr2_input().read().bits(),
            Register::Ccer => timer.ccer().read().bits(),
            Register::Cnt => timer.cnt().read().bits(),
            Register::Psc => timer.psc().read().bits(),
            Register::Arr => timer.arr().read().bits(),
            Register::Ccr3 => timer.ccr3().read().bits(),
        }
    }
}

/// A channel's pin, pulled up: one that is not connected stands still.
fn pulled_up<P: PinPull>(pin: impl Into<P>) {
    pin.into().set_internal_resistor(Pull::Up);
}

/// Takes a timer for ever.
fn timer<T: Deref + Enable + Reset>(timer: &T, rcc: &mut Rcc) -> Encoder {
    T::enable(rcc);
    T::reset(rcc);
    let block: *const T::Target = &raw const **timer;
    // SAFETY: the callers own the timer and give it up, for ever. Registers of TIM2 to TIM5 and TIM8 that are used here lie
    // at the same offsets (RM0090 18.4.21 and 17.4.21).
    #[allow(unsafe_code, reason = "the registers for ever")]
    Encoder(unsafe { Registers::new(block.cast()) })
}

/// A handwheel at the pins of a timer's channels 1 and 2.
#[expect(clippy::needless_pass_by_value, reason = "nobody else has the timer from now on")]
pub(crate) fn wheel<T>(
    device: T,
    a: impl Into<<T as TimCPin<0>>::Ch<PushPull>>,
    b: impl Into<<T as TimCPin<1>>::Ch<PushPull>>,
    rcc: &mut Rcc,
) -> Encoder
where
    T: Deref<Target: Sized> + Enable + Reset + TimCPin<0, Ch<PushPull>: PinPull> + TimCPin<1, Ch<PushPull>: PinPull>,
{
    let mut encoder = timer(&device, rcc);
    pulled_up::<<T as TimCPin<0>>::Ch<PushPull>>(a);
    pulled_up::<<T as TimCPin<1>>::Ch<PushPull>>(b);
    quadrature::count_encoder(&mut encoder, Filter::Slow, false);
    encoder
}

/// The spindle's encoder at the pins of TIM4's channels 1 and 2, its index at that of channel 3.
#[expect(clippy::needless_pass_by_value, reason = "nobody else has the timer from now on")]
pub(crate) fn spindle<T>(
    device: T,
    a: impl Into<<T as TimCPin<0>>::Ch<PushPull>>,
    b: impl Into<<T as TimCPin<1>>::Ch<PushPull>>,
    index: impl Into<<T as TimCPin<2>>::Ch<PushPull>>,
    rcc: &mut Rcc,
) -> Encoder
where
    T: Deref<Target: Sized>
        + Enable
        + Reset
        + TimCPin<0, Ch<PushPull>: PinPull>
        + TimCPin<1, Ch<PushPull>: PinPull>
        + TimCPin<2, Ch<PushPull>: PinPull>,
{
    let mut encoder = timer(&device, rcc);
    pulled_up::<<T as TimCPin<0>>::Ch<PushPull>>(a);
    pulled_up::<<T as TimCPin<1>>::Ch<PushPull>>(b);
    pulled_up::<<T as TimCPin<2>>::Ch<PushPull>>(index);
    quadrature::count_encoder(&mut encoder, Filter::Fast, true);
    encoder
}

/// Makes a pin of the board's two [ports](this::Ports) a pulled-up input: its bit in the word of levels, in which the
/// second port stands above the first.
pub(crate) fn at<const P: char, const N: u8, M: PinMode>(pin: Pin<P, N, M>) -> u32 {
    let second = const {
        let (first, second) = (<this::Ports as Pair>::FIRST, <this::Ports as Pair>::SECOND);
        assert!(N < 16 && (P as u32 == first as u32 || P as u32 == second as u32));
        P as u32 == second as u32
    };
    pin.into_pull_up_input();
    1 << N << if second { 16 } else { 0 }
}

/// Two ports.
trait Pair {
    const FIRST: char;
    const SECOND: char;
    /// Levels of all their pins.
    fn levels() -> u32;
}

impl<A: Place, B: Place> Pair for (A, B) {
    const FIRST: char = A::PORT;
    const SECOND: char = B::PORT;

    #[inline]
    fn levels() -> u32 {
        registers::<A>().idr().read().bits() & 0xFFFF | registers::<B>().idr().read().bits() << 16
    }
}

/// Encoders of a board.
pub(crate) struct Encoders {
    /// The handwheels of X and Z.
    pub(crate) wheels: PerAxis<Encoder>,
    /// The contour wheel, where a timer is left for it.
    pub(crate) contour: Option<Encoder>,
    /// The spindle.
    pub(crate) spindle: Encoder,
}

/// What is read: X, Z, contour and spindle in counts, index pulses, contacts that ask.
static READ: Published<6> = Published::new();

/// Reads encoders and contacts.
pub(crate) struct Controls {
    encoders: Encoders,
    wheels: PerAxis<Count>,
    contour: Count,
    spindle: Count,
    /// Index pulses.
    turns: u32,
    panel: Panel,
}

impl Controls {
    /// Reads these.
    pub(crate) fn new(encoders: Encoders, wiring: Wiring) -> Self {
        let wheels = PerAxis { x: Count::NONE, z: Count::NONE };
        let (contour, spindle) = (Count::NONE, Count::NONE);
        Self { encoders, wheels, contour, spindle, turns: 0, panel: Panel::new(wiring) }
    }

    /// Reads them at a tick's start, for the lathe; gives keys that went down.
    #[inline]
    pub(crate) fn read(&mut self, foreground: &mut Foreground<'_>) -> Keys {
        let Encoders { wheels, contour, spindle } = &mut self.encoders;
        let counts = quadrature::counter(spindle);
        // behind the counter: a pulse in between is a count or two ahead of it, and the difference has a sign
        let index = quadrature::index(spindle);
        let turned = Turned {
            wheels: PerAxis {
                x: self.wheels.x.take(quadrature::counter(&mut wheels.x)),
                z: self.wheels.z.take(quadrature::counter(&mut wheels.z)),
            },
            contour: contour.as_mut().map(|wheel| self.contour.take(quadrature::counter(wheel))),
            spindle: Reading { counts, index },
        };
        self.spindle.take(counts);
        self.turns = self.turns.wrapping_add(u32::from(index.is_some()));
        let keys = self.panel.serve(this::Ports::levels(), &turned, foreground);
        READ.publish(|[x, z, contour, spindle, turns, asks]| {
            x.store(self.wheels.x.total().cast_unsigned(), Relaxed);
            z.store(self.wheels.z.total().cast_unsigned(), Relaxed);
            contour.store(self.contour.total().cast_unsigned(), Relaxed);
            spindle.store(self.spindle.total().cast_unsigned(), Relaxed);
            turns.store(self.turns, Relaxed);
            asks.store(self.panel.asks().into(), Relaxed);
        });
        keys
    }
}

/// Tells the log what is read, for who connects it: at most four times a second, and only what has changed.
pub(crate) struct Teller {
    told: [u32; 6],
    waited: u8,
}

impl Teller {
    /// Has told nothing.
    pub(crate) const fn new() -> Self {
        Self { told: [0; 6], waited: 0 }
    }

    /// To be called by the background about once a tick.
    pub(crate) fn tell(&mut self) {
        self.waited = self.waited.wrapping_add(1);
        if self.waited != 0 {
            return;
        }
        let read = READ.read();
        if read == self.told {
            return;
        }
        self.told = read;
        let [x, z, contour, spindle, turns, asks] = read;
        defmt::info!(
            "x {=i32} z {=i32} contour {=i32} spindle {=i32} index {=u32} asks {=u32:014b}",
            x.cast_signed(),
            z.cast_signed(),
            contour.cast_signed(),
            spindle.cast_signed(),
            turns,
            asks
        );
    }
}
