import java.io.BufferedInputStream;
import java.io.DataInputStream;
import java.io.EOFException;
import java.io.FileInputStream;
import java.io.IOException;
import java.nio.charset.StandardCharsets;
import java.util.Map;
import java.util.TreeMap;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.LCMTypeDatabase;

/**
 * Names the channels of a log that lcm-spy could not show. It asks lcm-spy's own type database, and decodes as
 * lcm-spy does. The log is read here since LCM's Java reader passes over events of 16 MB and more.
 *
 * Exit code: 0 all channels decode, 1 some do not, 2 the log cannot be read.
 */
public class SpyCheck {
  private static final int SYNC = 0xEDA1DA01;
  private static final int MAX_CHANNEL = 255;
  private static final int MAX_MESSAGE = 256 << 20;
  /** LCM sends itself plain text on this channel when it starts. */
  private static final String SELF_TEST = "LCM_SELF_TEST";

  private static final class Channel {
    long messages;
    long refused;
    String type = "?";
    String problem = "";
  }

  public static void main(String[] arguments) {
    LCMTypeDatabase types = new LCMTypeDatabase();
    Map<String, Channel> channels = new TreeMap<>();
    try (DataInputStream log = new DataInputStream(new BufferedInputStream(new FileInputStream(arguments[0]), 1 << 20))) {
      while (readEvent(log, types, channels)) {}
    } catch (IOException error) {
      System.err.println(arguments[0] + ": " + error.getMessage());
      System.exit(2);
    }
    boolean good = true;
    for (Map.Entry<String, Channel> entry : channels.entrySet()) {
      Channel channel = entry.getValue();
      if (channel.refused == 0) {
        System.out.printf("%-40s %-22s %d%n", entry.getKey(), channel.type, channel.messages);
      } else {
        System.out.printf("%-40s DOES NOT DECODE: %d of %d, %s%n", entry.getKey(), channel.refused, channel.messages,
            channel.problem);
        good = false;
      }
    }
    if (channels.isEmpty()) {
      System.err.println(arguments[0] + ": no messages");
      System.exit(2);
    }
    System.exit(good ? 0 : 1);
  }

  /** One event: sync, number, time, two lengths, channel, data; all big-endian. Returns false at the end. */
  private static boolean readEvent(DataInputStream log, LCMTypeDatabase types, Map<String, Channel> channels)
      throws IOException {
    int first = log.read();
    if (first < 0) return false;
    try {
      int sync = first << 24 | log.readUnsignedByte() << 16 | log.readUnsignedShort();
      if (sync != SYNC) throw new IOException("not an LCM log, or damaged");
      log.readLong();
      log.readLong();
      int channelLength = log.readInt();
      int dataLength = log.readInt();
      if (channelLength < 1 || channelLength > MAX_CHANNEL || dataLength < 0 || dataLength > MAX_MESSAGE) {
        throw new IOException("an event claims an impossible size");
      }
      String name = new String(log.readNBytes(channelLength), StandardCharsets.UTF_8);
      byte[] data = log.readNBytes(dataLength);
      if (data.length != dataLength) throw new EOFException();
      if (!name.equals(SELF_TEST)) decode(data, types, channels.computeIfAbsent(name, unused -> new Channel()));
      return true;
    } catch (EOFException error) {
      throw new IOException("ends inside an event");
    }
  }

  private static void decode(byte[] data, LCMTypeDatabase types, Channel channel) {
    channel.messages++;
    try {
      if (data.length < 8) throw new IOException("shorter than a fingerprint");
      long fingerprint = new LCMDataInputStream(data).readLong();
      Class<?> type = types.getClassByFingerprint(fingerprint);
      if (type == null) throw new IOException(String.format("unknown type 0x%016x", fingerprint));
      channel.type = type.getSimpleName();
      LCMDataInputStream message = new LCMDataInputStream(data);
      type.getConstructor(java.io.DataInput.class).newInstance(message);
      if (message.available() != 0) throw new IOException(message.available() + " bytes left over");
    } catch (Exception error) {
      channel.refused++;
      Throwable cause = error.getCause() != null ? error.getCause() : error;
      channel.problem = cause.getMessage() != null ? cause.getMessage() : cause.toString();
    }
  }
}
