//! Programs that are refused: each by a message that names place and cause.

use super::bench::{Bench, refused, refused_setting};

#[test]
fn an_empty_file_is_refused() {
    refused("", &["p.nc:1:1", "empty program", "write a program"]);
}

#[test]
fn a_file_of_comments_is_refused() {
    refused("%\n(nothing)\n%\n", &["empty program"]);
}

#[test]
fn binary_garbage_is_refused() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..4 {
        let bytes: Vec<u8> = std::iter::repeat_with(|| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state.to_le_bytes()[3]
        })
        .take(4_000)
        .collect();
        refused(bytes, &["p.nc:1:", "error"]);
    }
}

#[test]
fn zero_bytes_are_refused() {
    refused([0; 100], &["p.nc:1:1", "byte 00", "delete it"]);
}

#[test]
fn a_line_of_a_megabyte_is_refused() {
    let line = format!("G1 X1 F100 {}\nM30\n", "X".repeat(1_000_000));
    refused(line, &["p.nc:1:1", "line of 1000011 bytes", "at most 256"]);
}

#[test]
fn a_message_about_a_megabyte_is_short() {
    let bench = Bench::with("X1".repeat(500_000));
    assert!(bench.turn(&["p.nc"]).err.len() < 2_000);
}

#[test]
fn a_motion_without_an_end_point_is_refused() {
    refused("G1 F100\nM30\n", &["p.nc:1:1", "G1 without an end point", "1 | G1 F100", "write the end point"]);
}

#[test]
fn an_arc_without_an_end_point_is_refused() {
    refused("G2 R5 F100\nM30\n", &["p.nc:1:1", "G2 without an end point"]);
}

#[test]
fn an_arc_without_a_centre_is_refused() {
    refused("G2 X5 Z5 F100\nM30\n", &["p.nc:1:1", "without a centre", "write I and K"]);
}

#[test]
fn an_arc_whose_radius_is_too_small_is_refused() {
    refused("G2 X10 Z-10 R2 F100\nM30\n", &["p.nc:1:13", "R2 is too small", "at least 7.071068 mm"]);
}

#[test]
fn an_arc_whose_radii_differ_is_refused() {
    refused("G2 X10 Z-10 I3 K0 F100\nM30\n", &["p.nc:1:13", "3 mm from the centre", "tolerance 0.01 mm"]);
}

#[test]
fn a_full_circle_by_radius_is_refused() {
    refused("G2 X0 Z0 R5 F100\nM30\n", &["p.nc:1:10", "R5", "write I and K instead of R"]);
}

#[test]
fn a_circle_about_less_than_a_pulse_is_refused() {
    let why = ["p.nc:1:1", "about less than a pulse: nothing would move", "correct I and K"];
    refused("G2 X0 Z0 I0.00249 K0 F10\nM30\n", &why);
    // and three quarters of one, whose ends round to one point
    refused("G2 X-0.0005 Z0.0005 I0 K0.0005 F10\nM30\n", &why);
    // a pulse is walked: to its four corners and back
    let bench = Bench::with("G2 X0 Z0 I0.0025 K0 F10\nM30\n");
    assert!(bench.turn(&["p.nc"]).out.contains("events"));
}

#[test]
fn an_arc_about_its_start_is_refused() {
    refused("G2 X1 Z1 I0 K0 F10\nM30\n", &["p.nc:1:10", "arc with radius zero", "write R, or I and K"]);
}

#[test]
fn a_pitch_table_that_nobody_gave_is_refused() {
    let what = "z.pitch_table = true, but there is no table for z: give one with --pitch-table";
    refused_setting("z.pitch_table=true", &[what]);
}

#[test]
fn a_feed_below_the_slowest_is_refused() {
    refused(
        "G1 X1 F0.009\nM30\n",
        &["p.nc:1:7", "F0.009 is below the slowest feed, 0.01 mm/min", "0.01 mm/min or more"],
    );
}

#[test]
fn a_feed_of_zero_is_refused() {
    refused("G1 X1 F0\nM30\n", &["p.nc:1:7", "F0 is no feed above zero", "write F above zero"]);
}

#[test]
fn a_negative_feed_is_refused() {
    refused("G1 X1 F-5\nM30\n", &["p.nc:1:7", "F-5 is no feed above zero"]);
}

#[test]
fn a_missing_feed_is_refused() {
    refused("G1 X1\nM30\n", &["p.nc:1:1", "G1 without a feed", "write F"]);
}

#[test]
fn a_feed_above_the_machine_is_refused() {
    refused("G1 X1 F5000.1\nM30\n", &["p.nc:1:7", "F5000.1", "X 5000, Z 5000 mm/min", "up to 5000 mm/min"]);
}

#[test]
fn a_number_past_the_range_is_refused() {
    refused("G0 Z-2100.1\nM30\n", &["p.nc:1:4", "Z-2100.1", "2100 mm"]);
}

#[test]
fn an_incremental_number_that_leads_past_the_range_is_refused() {
    refused("G0 X2000\nU200\nM30\n", &["p.nc:2:1", "U200 leads X past 2100 mm"]);
}

#[test]
fn a_number_of_too_many_digits_is_refused() {
    refused("G0 X9999999999999999999999\nM30\n", &["p.nc:1:4", "more than 18 digits"]);
}

#[test]
fn an_unknown_g_is_refused() {
    refused("G1 X1 F100\nG5 X2\nM30\n", &["p.nc:2:1", "G5 is not supported", "2 | G5 X2", "G0 G1 G2 G3 G4"]);
}

#[test]
fn an_unknown_m_is_refused() {
    refused("M98\nM30\n", &["p.nc:1:1", "M98 is not supported", "M0 M1 M2"]);
}

#[test]
fn an_unknown_letter_is_refused() {
    refused("G1 X1.0 Y2 F100\nM30\n", &["p.nc:1:9", "Y2", "a lathe moves X and Z"]);
}

#[test]
fn two_words_of_one_modal_group_are_refused() {
    for (line, words) in [
        ("G0 G1 X1 F100", "G0 and G1"),
        ("G90 G91 G1 X1 F100", "G90 and G91"),
        ("G20 G21 G1 X1 F100", "G20 and G21"),
        ("G7 G8 G1 X1 F100", "G7 and G8"),
        ("M3 M4", "M3 and M4"),
        ("M2 M30", "M2 and M30"),
    ] {
        refused(format!("{line}\nM30\n"), &["p.nc:1:", words, "exclude each other", "delete one"]);
    }
}

#[test]
fn a_word_given_twice_is_refused() {
    refused("G1 X1 X2 F100\nM30\n", &["p.nc:1:7", "X1 and X2 in one block"]);
}

#[test]
fn x_with_u_is_refused() {
    refused("G1 X1 U1 F100\nM30\n", &["p.nc:1:7", "X with U", "write X (absolute) or U (incremental)"]);
}

#[test]
fn z_with_w_is_refused() {
    refused("G1 Z1 W1 F100\nM30\n", &["p.nc:1:7", "Z with W"]);
}

#[test]
fn an_open_comment_is_refused() {
    refused("G1 X1 F100 (abc\nM30\n", &["p.nc:1:12", "comment without )"]);
}

#[test]
fn a_dwell_without_time_is_refused() {
    refused("G4\nM30\n", &["p.nc:1:1", "G4 without P", "seconds"]);
}

#[test]
fn all_errors_of_a_file_are_told() {
    refused("G1 X\nG5\nG1 X1 U1 F100\nM30\n", &["p.nc:1:4", "p.nc:2:1", "p.nc:3:7", "3 error(s)"]);
}

#[test]
fn errors_past_a_hundred_are_counted() {
    refused("G5\n".repeat(1_000), &["p.nc:100:1", "1000 error(s)", "900 of them not shown"]);
}

#[test]
fn the_word_is_marked_under_the_line() {
    refused("G1 X1 F0\nM30\n", &[" 1 | G1 X1 F0\n   |       ^^\n"]);
}

#[test]
fn a_tabulator_keeps_the_mark_under_the_word() {
    refused("G1\tX1\tF0\nM30\n", &[" 1 | G1 X1 F0\n   |       ^^\n"]);
}

#[test]
fn what_stands_behind_the_end_is_not_read() {
    let bench = Bench::with("G1 X1 F100\nM30\nG5 @\n");
    assert_eq!(bench.report(&[])["pulses"]["x"], 800);
}
