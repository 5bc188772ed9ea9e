//! Copies of whole words, eight at a time.
//!
//! A block that is taken and begun is copied a dozen times, up to 680 bytes each. The compiler's own loop moves one word at a time,
//! 24 instructions for 32 bytes; with eight registers at once it is four, and about half the clocks. The names are those that the
//! ARM EABI has for copies between addresses that are multiples of 4 and of 8; the compiler's own are weak.

#![allow(unsafe_code, reason = "an assembler's code is taken at its word")]

use core::arch::global_asm;

global_asm!(
    ".section .text.__aeabi_memcpy4, \"ax\", %progbits",
    ".global __aeabi_memcpy4",
    ".global __aeabi_memcpy8",
    ".type __aeabi_memcpy4, %function",
    ".type __aeabi_memcpy8, %function",
    ".thumb_func",
    "__aeabi_memcpy4:",
    ".thumb_func",
    "__aeabi_memcpy8:",
    "push {{r4-r9, lr}}",
    "subs r2, #32",
    "blo 2f",
    "1:",
    "ldmia r1!, {{r3-r9, ip}}",
    "stmia r0!, {{r3-r9, ip}}",
    "subs r2, #32",
    "bhs 1b",
    // what is left is the length modulo 32: its bits of 16 and 8 bytes, of 4 and 2, of 1
    "2:",
    "lsls r3, r2, #28",
    "itt cs",
    "ldmiacs r1!, {{r4-r7}}",
    "stmiacs r0!, {{r4-r7}}",
    "itt mi",
    "ldmiami r1!, {{r4, r5}}",
    "stmiami r0!, {{r4, r5}}",
    "lsls r3, r2, #30",
    "itt cs",
    "ldrcs r4, [r1], #4",
    "strcs r4, [r0], #4",
    "itt mi",
    "ldrhmi r4, [r1], #2",
    "strhmi r4, [r0], #2",
    "lsls r3, r2, #31",
    "itt mi",
    "ldrbmi r4, [r1]",
    "strbmi r4, [r0]",
    "pop {{r4-r9, pc}}",
    ".size __aeabi_memcpy4, . - __aeabi_memcpy4",
    ".size __aeabi_memcpy8, . - __aeabi_memcpy8",
);
