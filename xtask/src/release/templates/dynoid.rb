class Dynoid < Formula
  desc "Recordings of a dynamometer test bench in, a validated bench model out"
  homepage "<<repository>>"
  version "<<version>>"
  license any_of: ["MIT", "Apache-2.0"]

  on_macos do
    on_arm do
      url "<<repository>>/releases/download/v<<version>>/dynoid-<<version>>-aarch64-apple-darwin.tar.gz"
      sha256 "<<sha256 dynoid-<<version>>-aarch64-apple-darwin.tar.gz>>"
    end
    on_intel do
      url "<<repository>>/releases/download/v<<version>>/dynoid-<<version>>-x86_64-apple-darwin.tar.gz"
      sha256 "<<sha256 dynoid-<<version>>-x86_64-apple-darwin.tar.gz>>"
    end
  end

  on_linux do
    on_arm do
      url "<<repository>>/releases/download/v<<version>>/dynoid-<<version>>-aarch64-unknown-linux-musl.tar.gz"
      sha256 "<<sha256 dynoid-<<version>>-aarch64-unknown-linux-musl.tar.gz>>"
    end
    on_intel do
      url "<<repository>>/releases/download/v<<version>>/dynoid-<<version>>-x86_64-unknown-linux-musl.tar.gz"
      sha256 "<<sha256 dynoid-<<version>>-x86_64-unknown-linux-musl.tar.gz>>"
    end
  end

  def install
    bin.install "dynoid"
    man1.install Dir["man/man1/*"]
    bash_completion.install "completions/dynoid.bash" => "dynoid"
    zsh_completion.install "completions/_dynoid"
    fish_completion.install "completions/dynoid.fish"
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/dynoid --version")
  end
end
