//! Whole cycles on the desktop.
