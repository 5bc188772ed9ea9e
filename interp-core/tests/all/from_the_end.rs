//! Walkers that stand at a curve's end are those that have walked there.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, reason = "a test")]

use interp_core::curve::Walker;
use interp_core::curve::dda::IntegratedLine;
use interp_core::curve::fraction::FractionLine;
use interp_core::curve::line::Line;
use interp_core::curve::point_comparison::ComparedLine;
use interp_core::curve::rate_multiplier::MultipliedLine;
use proptest::prelude::*;

/// Walks to the end, and back from there and from `end`: the same steps.
fn agree(mut walker: impl Walker, mut end: impl Walker) -> Result<(), TestCaseError> {
    while walker.next_step().is_some() {}
    loop {
        let (walked, set) = (walker.previous_step(), end.previous_step());
        prop_assert_eq!(walked, set);
        if walked.is_none() {
            return Ok(());
        }
    }
}

proptest! {
    #[test]
    fn the_way_back_from_the_end_of_a_line_is_that_of_the_walked_one(x in -3000..=3000_i32, z in -3000..=3000_i32) {
        prop_assume!((x, z) != (0, 0));
        let line = Line::new(x, z).unwrap();
        agree(line.walk(), line.walk_from_end())?;
        agree(ComparedLine::new(line), ComparedLine::end_of(line))?;
        agree(IntegratedLine::new(line), IntegratedLine::end_of(line))?;
        agree(MultipliedLine::new(line), MultipliedLine::end_of(line))?;
        agree(FractionLine::new(line), FractionLine::end_of(line))?;
    }
}
