//! Leaves the symbols out of the program.
//!
//! `strip` of the profile would do, but Cargo keeps the symbols of a package that has an optimisation of its own.

#![allow(clippy::print_stdout)] // Cargo reads what a build script prints.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|found| found == value);
    if is("PROFILE", "release") && is("CARGO_CFG_TARGET_OS", "linux") {
        println!("cargo::rustc-link-arg-bins=-Wl,--strip-all");
    }
}
