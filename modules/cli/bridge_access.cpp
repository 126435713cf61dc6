// token, cert: who may come in through the bridge, and how it proves who it is.

#include <unistd.h>

#include <chrono>
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "access/certificate.hpp"
#include "access/site_files.hpp"
#include "access/token_store.hpp"
#include "cli/command.hpp"
#include "cli/table.hpp"
#include "cli/times.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

std::int64_t now() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

hmd::Role role_of(const std::string& text) {
  hmd::Role role = hmd::Role::kView;
  hmd::Problem none;
  (void)hmd::read_value(hmd::Json(text), role, none);  // the option was checked
  return role;
}

struct TokenOptions {
  std::string op, name, role = "view";
};

Outcome token(const TokenOptions& options, const Common& common) {
  hmd::TokenStore store(hmd::token_file(common.site()));
  if (options.op == "list") {
    const auto entries = store.list();
    if (!entries) return fail(entries.error());
    nlohmann::json array = nlohmann::json::array();
    std::vector<std::vector<std::string>> rows = {{"name", "role", "since"}};
    for (const auto& entry : *entries) {
      array.push_back({{"name", entry.name}, {"role", text_of(entry.role)}, {"created", entry.created}});
      rows.push_back({entry.name, text_of(entry.role), format_local_time(entry.created)});
    }
    common.print({{"tokens", array}}, entries->empty() ? "no tokens" : format_table(rows, "lll"));
    return Exit::kDone;
  }
  if (options.name.empty()) return fail(Exit::kUnusable, "BAD_REQUEST", "token " + options.op + " takes a name");
  if (options.op == "remove") {
    const auto removed = store.remove(options.name);
    if (!removed) return fail(removed.error());
    common.print({{"name", options.name}},
                 "token " + options.name + " opens nothing any more; who is in stays until they leave");
    return Exit::kDone;
  }
  const auto made = store.add(options.name, role_of(options.role), now());
  if (!made) return fail(made.error());
  common.print({{"name", options.name}, {"role", options.role}, {"token", *made}},
               *made + "\nThis is " + options.name + "'s token (" + options.role +
                   "). It is shown once and stored as a hash only.");
  return Exit::kDone;
}

/// The host's own name, and that with .local, by which most networks know it.
std::vector<std::string> own_names() {
  char name[256] = {};
  if (gethostname(name, sizeof(name) - 1) != 0 || name[0] == '\0') return {"localhost"};
  const std::string host = name;
  return host.find('.') != std::string::npos ? std::vector<std::string>{host, "localhost"}
                                             : std::vector<std::string>{host, host + ".local", "localhost"};
}

Result<void> write_text(const std::filesystem::path& file, const std::string& text, bool secret) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  auto written = write_whole_file(file, {bytes, text.size()});
  if (!written || !secret) return written;
  std::error_code error;
  std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write, error);
  if (error) return refuse(Code::kIo, file.string() + ": " + error.message());
  return {};
}

struct CertOptions {
  std::vector<std::string> names;
  bool overwrite = false;
};

Outcome cert(const CertOptions& options, const Common& common) {
  const Site site = common.site();
  const std::filesystem::path file = hmd::certificate_file(site), key = hmd::key_file(site);
  std::error_code error;
  if (!options.overwrite && (std::filesystem::exists(file, error) || std::filesystem::exists(key, error))) {
    return fail(Exit::kUnusable, name(Code::kExists),
                file.string() + " is there; --overwrite makes another, which headsets accept anew");
  }
  const auto made = hmd::make_certificate(options.names.empty() ? own_names() : options.names, now() / 1'000'000);
  if (!made) return fail(made.error());
  std::filesystem::create_directories(file.parent_path(), error);
  std::filesystem::create_directories(key.parent_path(), error);
  // The key first, readable to nobody else before there is anything in it.
  auto written = write_text(key, "", true);
  if (written) written = write_text(key, made->key, true);
  if (written) written = write_text(file, made->certificate, false);
  if (!written) return fail(written.error());
  const std::string host = options.names.empty() ? own_names()[0] : options.names[0];
  const std::string address = "https://" + host + ":" + std::to_string(site.bridge.port) + "/";
  common.print(
      {{"certificate", file.string()}, {"key", key.string()}, {"fingerprint", made->fingerprint}, {"address", address}},
      file.string() + "\nSHA-256 " + made->fingerprint +
          "\n\nIn the site file:  bridge: {listen: 0.0.0.0, tls: true}\nThen, in the headset's browser, open " +
          address +
          "\nIt says that the connection is not private, since nobody but you vouches for this certificate. Choose"
          "\nAdvanced, compare the SHA-256 fingerprint if the browser shows it, and proceed; once is enough until it"
          "\nexpires in 397 days. The address must be one of the names that the certificate was made for.");
  return Exit::kDone;
}

}  // namespace

void add_bridge_access(Program& program) {
  auto tokens = std::make_shared<TokenOptions>();
  CLI::App& token_command = program.add("token", "who may come in through the bridge from other machines",
                                        [tokens](const Common& common) { return token(*tokens, common); });
  token_command.add_option("op", tokens->op, "add, list or remove")
      ->required()
      ->check(CLI::IsMember({"add", "list", "remove"}));
  token_command.add_option("name", tokens->name, "whose: stands in the history of what they do");
  token_command.add_option("--role", tokens->role, "view, edit, or robot: edit, and send robots")
      ->capture_default_str()
      ->check(CLI::IsMember({"view", "edit", "robot"}));

  auto certs = std::make_shared<CertOptions>();
  CLI::App& cert_command = program.add("cert", "makes a certificate for the bridge, and says how a headset accepts it",
                                       [certs](const Common& common) { return cert(*certs, common); });
  cert_command.add_option("names", certs->names, "host names and addresses it is reached by; without them this host's");
  cert_command.add_flag("--overwrite", certs->overwrite, "in place of the one that is there");
}

}  // namespace concord
