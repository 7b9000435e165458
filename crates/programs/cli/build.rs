//! Leaves the symbols out of the program.
//!
//! `strip` of the profile would do, but Cargo keeps the symbols of a package that has an optimisation of its own.

#![allow(clippy::print_stdout)] // Cargo reads what a build script prints.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // A profile names functions.
    println!("cargo::rerun-if-env-changed=DYNOID_SYMBOLS");
    let has_symbols = std::env::var_os("DYNOID_SYMBOLS").is_some();
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|found| found == value);
    if is("PROFILE", "release") && is("CARGO_CFG_TARGET_OS", "linux") && !has_symbols {
        println!("cargo::rustc-link-arg-bins=-Wl,--strip-all");
    }
}
