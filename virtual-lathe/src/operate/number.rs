//! Decimal numbers of a script, exact.

/// A decimal number times 10^`places`, a half rounded away from zero. `None` where it is no number, or too large.
///
/// ```
/// # use virtual_lathe::operate::number::scaled;
/// assert_eq!(scaled("-0.0015", 3), Some(-2));
/// assert_eq!(scaled("12", 6), Some(12_000_000));
/// assert_eq!(scaled("1e3", 6), None);
/// ```
#[must_use]
pub fn scaled(text: &str, places: u32) -> Option<i64> {
    let (whole, rest) = parts(text, places)?;
    let half = rest.bytes().next().is_some_and(|digit| digit >= b'5');
    let magnitude = whole.checked_add(i64::from(half))?;
    Some(if text.starts_with('-') { -magnitude } else { magnitude })
}

/// The same of a number that is not negative, rounded up.
///
/// ```
/// # use virtual_lathe::operate::number::rounded_up;
/// assert_eq!(rounded_up("1.1", 3), Some(1100));
/// assert_eq!(rounded_up("0.0001", 3), Some(1));
/// assert_eq!(rounded_up("-1", 3), None);
/// ```
#[must_use]
pub fn rounded_up(text: &str, places: u32) -> Option<u64> {
    if text.starts_with('-') {
        return None;
    }
    let (whole, rest) = parts(text, places)?;
    let more = rest.bytes().any(|digit| digit != b'0');
    u64::try_from(whole).ok()?.checked_add(u64::from(more))
}

/// Magnitude times 10^`places`, rounded down, and the digits that are left.
fn parts(text: &str, places: u32) -> Option<(i64, &str)> {
    let text = text.strip_prefix(['+', '-']).unwrap_or(text);
    let (whole, part) = text.split_once('.').unwrap_or((text, ""));
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() && part.is_empty() || !digits(whole) || !digits(part) {
        return None;
    }
    let kept = part.len().min(places as usize);
    let (used, rest) = part.split_at(kept);
    let zeros = places - u32::try_from(kept).ok()?;
    let number = |text: &str| if text.is_empty() { Some(0) } else { text.parse::<i64>().ok() };
    let whole = number(whole)?.checked_mul(10_i64.checked_pow(places)?)?;
    let part = number(used)?.checked_mul(10_i64.checked_pow(zeros)?)?;
    Some((whole.checked_add(part)?, rest))
}
