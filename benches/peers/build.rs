//! Compiles the shim around the other libraries, as their manuals advise: optimised, for the machine it runs on.

fn main() {
    println!("cargo::rerun-if-changed=shim");
    let mut build = cc::Build::new();
    build.cpp(true).std("c++17").opt_level(3).define("NDEBUG", None);
    for folder in ["suitesparse", "eigen3"] {
        // System headers, so that their warnings are not ours.
        build.flag(format!("-isystem/usr/include/{folder}"));
    }
    build.flag_if_supported("-march=native");
    // GCC 12 takes its own AVX-512 intrinsics for uninitialised.
    build.flag_if_supported("-Wno-maybe-uninitialized");
    for file in ["umfpack", "klu", "sparse_lu", "ldlt", "peer"] {
        build.file(format!("shim/{file}.cpp"));
    }
    build.compile("peers_shim");
    for library in ["umfpack", "klu"] {
        println!("cargo::rustc-link-lib={library}");
    }
}
