//! The call graph of an image: no path from a vector or task to a panic.
//!
//! Only branches are decoded, so no disassembler is needed. Nodes are functions; edges are branches that leave a
//! function, and addresses of functions that it loads (literals, MOVW with MOVT). An indirect call (BLX, BX, LDR PC,
//! MOV PC) may lead to every function whose address is loaded anywhere or stands in constants, so nothing has to be
//! listed by hand. Left out are the reset vector and what only it reaches: start-up may panic, nothing moves yet.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use anyhow::{Context as _, Result, bail};

use crate::firmware::{self, Board};
use crate::image::{Content, Image};
use crate::toolchain::Toolchain;

/// Parts of names that only panicking functions have.
const PANICS: [&str; 7] = [
    "rust_begin_unwind",
    "9panicking",
    "panic_fmt",
    "panic_const",
    "unwrap_failed",
    "expect_failed",
    "panic_bounds_check",
];

/// Where the vector table begins, and its first entries: stack, reset.
pub(crate) const VECTORS: &str = ".vector_table";
const RESET: u32 = 1;

/// `cargo xtask no-panic`, second half.
pub(crate) fn run(boards: &[Board]) -> Result<()> {
    let toolchain = Toolchain::find()?;
    for board in boards {
        let image = Image::read(&firmware::build(&toolchain, *board)?)?;
        let graph = Graph::of(&image)?;
        let reached = graph.check(&image).with_context(|| format!("the image of {}", board.name()))?;
        println!(
            "{}: {} functions, {} roots reach {reached} of them and no panic",
            board.name(),
            image.functions.len(),
            graph.roots.len()
        );
    }
    // a check that cannot fail proves nothing, and an image may well have no panic at all
    let image = Image::read(&firmware::build_with(&toolchain, Board::Qemu, Some("planted-panic"))?)?;
    match Graph::of(&image)?.check(&image) {
        Ok(_) => bail!("the check of the call graph did not find a planted panic"),
        Err(found) => println!("a planted panic: {}", found.to_string().replace("\n ", "")),
    }
    Ok(())
}

/// A call graph.
pub(crate) struct Graph {
    /// From a function to those that it may call.
    edges: BTreeMap<u32, BTreeSet<u32>>,
    /// Functions with an indirect call.
    indirect: BTreeSet<u32>,
    /// Functions whose address is taken.
    taken: BTreeSet<u32>,
    /// Vectors other than reset, and `idle`, which `main` calls when start-up is over.
    roots: BTreeSet<u32>,
}

/// What an instruction does to the graph.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Effect {
    None,
    /// Branches to an address.
    To(u32),
    /// Branches to where a register or memory says.
    Indirect,
    /// Loads the low or high half of a register.
    Low(u16, u16),
    High(u16, u16),
}

/// Decodes the instruction at `at`: its effect and length.
fn decode(at: u32, first: u16, second: u16) -> (Effect, u32) {
    let w = u32::from(first);
    let x = u32::from(second);
    let relative = |offset: u32, bits: u32| {
        let shift = 32 - bits;
        at.wrapping_add(4).wrapping_add(((offset << shift).cast_signed() >> shift).cast_unsigned())
    };
    if w >> 11 < 0x1D {
        let effect = if w >> 12 == 0xD && (w >> 8 & 15) < 14 {
            Effect::To(relative((w & 0xFF) << 1, 9))
        } else if w >> 11 == 0x1C {
            Effect::To(relative((w & 0x7FF) << 1, 12))
        } else if w & 0xF500 == 0xB100 {
            Effect::To(at.wrapping_add(4).wrapping_add(((w >> 9 & 1) << 5 | (w >> 3 & 31)) << 1))
        } else if w & 0xFF80 == 0x4780
            || w & 0xFF80 == 0x4700 && w >> 3 & 15 != 14
            || w & 0xFF87 == 0x4687 && w >> 3 & 15 != 14
        {
            Effect::Indirect
        } else {
            Effect::None
        };
        return (effect, 2);
    }
    let mut effect = Effect::None;
    if w >> 11 == 0x1E && x >> 15 == 1 {
        let (s, j1, j2) = (w >> 10 & 1, x >> 13 & 1, x >> 11 & 1);
        if x >> 12 & 1 == 1 {
            // BL and B
            let (i1, i2) = (1 ^ j1 ^ s, 1 ^ j2 ^ s);
            effect = Effect::To(relative(s << 24 | i1 << 23 | i2 << 22 | (w & 0x3FF) << 12 | (x & 0x7FF) << 1, 25));
        } else if x >> 12 & 5 == 0 && (w >> 6 & 15) < 14 {
            effect = Effect::To(relative(s << 20 | j2 << 19 | j1 << 18 | (w & 0x3F) << 12 | (x & 0x7FF) << 1, 21));
        }
    } else if (w & 0xFBF0 == 0xF240 || w & 0xFBF0 == 0xF2C0) && x >> 15 == 0 {
        let value = (first & 15) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 255;
        let register = second >> 8 & 15;
        effect = if w & 0xFBF0 == 0xF240 { Effect::Low(register, value) } else { Effect::High(register, value) };
    } else if (w & 0xFFF0 == 0xF8D0 || (w & 0xFFF0 == 0xF850 && w & 15 != 13) || w & 0xFF7F == 0xF85F) && x >> 12 == 15
    {
        effect = Effect::Indirect;
    }
    (effect, 4)
}

impl Graph {
    /// The graph of an image.
    pub(crate) fn of(image: &Image) -> Result<Self> {
        let mut graph =
            Self { edges: BTreeMap::new(), indirect: BTreeSet::new(), taken: BTreeSet::new(), roots: BTreeSet::new() };
        for (start, function) in &image.functions {
            graph.function(image, *start, start.saturating_add(function.size));
        }
        for (start, bytes, name) in &image.sections {
            if name == VECTORS || name == ".text" || name.starts_with(".ARM") {
                continue;
            }
            for at in (start.next_multiple_of(4)..start.saturating_add(u32::try_from(bytes.len())?)).step_by(4) {
                let target = image.word(at).filter(|word| word & 1 == 1).map(|word| word & !1);
                graph.taken.extend(target.filter(|target| image.functions.contains_key(target)));
            }
        }
        let (start, bytes, _) =
            image.sections.iter().find(|(_, _, name)| name == VECTORS).context("the image has no vector table")?;
        for number in RESET + 1..u32::try_from(bytes.len())? / 4 {
            let vector = image.word(start + 4 * number).filter(|word| word & 1 == 1).map(|word| word & !1);
            graph.roots.extend(vector);
        }
        let idle = image.functions.iter().filter(|(_, f)| f.names.iter().any(|name| name.contains("3app4idle")));
        graph.roots.extend(idle.map(|(at, _)| *at));
        Ok(graph)
    }

    fn function(&mut self, image: &Image, start: u32, end: u32) {
        let mut low: BTreeMap<u16, u16> = BTreeMap::new();
        let edges = self.edges.entry(start).or_default();
        let mut load = |word: u32| {
            let target = word & !1;
            if word & 1 == 1 && image.functions.contains_key(&target) {
                self.taken.insert(target);
                edges.insert(target);
            }
        };
        let mut branches = Vec::new();
        let mut at = start;
        while at < end {
            let content = image.contents.range(..=at).next_back().map(|(_, content)| *content);
            if content == Some(Content::Data) {
                let whole = at.is_multiple_of(4) && at + 4 <= end;
                if whole && let Some(word) = image.word(at) {
                    load(word);
                }
                at += if whole { 4 } else { 2 };
                continue;
            }
            let Some(first) = image.half(at) else { break };
            let (effect, length) = decode(at, first, image.half(at + 2).unwrap_or(0));
            match effect {
                Effect::None => {}
                Effect::To(target) if (start..end).contains(&target) => {}
                Effect::To(target) => branches.push(target),
                Effect::Indirect => drop(self.indirect.insert(start)),
                Effect::Low(register, value) => drop(low.insert(register, value)),
                Effect::High(register, value) => {
                    if let Some(low) = low.get(&register) {
                        load(u32::from(value) << 16 | u32::from(*low));
                    }
                }
            }
            at += length;
        }
        for target in branches {
            // a branch into the middle of a function counts as a call of it
            if let Some((owner, _)) = image.functions.range(..=target).next_back() {
                edges.insert(*owner);
            }
        }
    }

    /// Functions that may run where `start` does, itself included.
    pub(crate) fn reached(&self, start: u32) -> BTreeSet<u32> {
        let (mut reached, mut queue) = (BTreeSet::from([start]), vec![start]);
        while let Some(at) = queue.pop() {
            let none = BTreeSet::new();
            let indirect = if self.indirect.contains(&at) { &self.taken } else { &none };
            let next = self.edges.get(&at).into_iter().flatten().chain(indirect);
            queue.extend(next.filter(|next| reached.insert(**next)));
        }
        reached
    }

    /// Fails with a path where a panic can be reached; else how many functions can.
    pub(crate) fn check(&self, image: &Image) -> Result<usize> {
        let name = |at: &u32| image.functions.get(at).and_then(|f| f.names.first()).map_or("?", String::as_str);
        let panics = |at: &u32| {
            image.functions.get(at).is_some_and(|f| f.names.iter().any(|name| PANICS.iter().any(|p| name.contains(p))))
        };
        let mut from: BTreeMap<u32, Option<u32>> = self.roots.iter().map(|root| (*root, None)).collect();
        let mut queue: VecDeque<u32> = self.roots.iter().copied().collect();
        let mut paths = Vec::new();
        while let Some(at) = queue.pop_front() {
            if panics(&at) {
                let mut path = vec![name(&at)];
                let mut here = at;
                while let Some(Some(before)) = from.get(&here) {
                    path.push(name(before));
                    here = *before;
                }
                path.reverse();
                paths.push(path.join(" -> "));
                continue;
            }
            let none = BTreeSet::new();
            let indirect = if self.indirect.contains(&at) { &self.taken } else { &none };
            for next in self.edges.get(&at).into_iter().flatten().chain(indirect) {
                if !from.contains_key(next) {
                    from.insert(*next, Some(at));
                    queue.push_back(*next);
                }
            }
        }
        if !paths.is_empty() {
            bail!("a panic can be reached:\n  {}", paths.join("\n  "));
        }
        Ok(from.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_are_decoded_as_the_architecture_manual_encodes_them() {
        // bl .+0x1000, b .-4, beq .+6, cbz r0 .+6, blx r3, bx lr, b.w .-8, beq.w .+0x100
        assert_eq!(decode(0x800, 0xF000, 0xFFFE), (Effect::To(0x1800), 4));
        assert_eq!(decode(0x800, 0xE7FC, 0), (Effect::To(0x7FC), 2));
        assert_eq!(decode(0x800, 0xD001, 0), (Effect::To(0x806), 2));
        assert_eq!(decode(0x800, 0xB108, 0), (Effect::To(0x806), 2));
        assert_eq!(decode(0x800, 0x4798, 0), (Effect::Indirect, 2));
        assert_eq!(decode(0x800, 0x4770, 0), (Effect::None, 2));
        assert_eq!(decode(0x800, 0xF7FF, 0xBFFC), (Effect::To(0x7FC), 4));
        assert_eq!(decode(0x800, 0xF000, 0x807E), (Effect::To(0x900), 4));
        // movw r0, #0x1235; movt r0, #0x0800
        assert_eq!(decode(0x800, 0xF241, 0x2035), (Effect::Low(0, 0x1235), 4));
        assert_eq!(decode(0x800, 0xF6C0, 0x0000), (Effect::High(0, 0x0800), 4));
    }
}
