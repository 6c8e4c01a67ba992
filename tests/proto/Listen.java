import java.io.DataInput;
import java.io.IOException;
import java.lang.reflect.Array;
import java.lang.reflect.Constructor;
import java.lang.reflect.Field;
import java.lang.reflect.Modifier;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;

/**
 * Decodes Waymark's messages by the shipped jar and prints every field, one message after the other, until COUNT have
 * come. Usage: java Listen URL PREFIX COUNT [CHANNEL]. Says "listening" when it does.
 */
public final class Listen implements LCMSubscriber {
    private final String prefix;
    private int left;

    private Listen(String prefix, int count) {
        this.prefix = prefix;
        this.left = count;
    }

    public static void main(String[] args) throws Exception {
        LCM lcm = new LCM(args[0]);
        Listen listener = new Listen(args[1], Integer.parseInt(args[2]));
        lcm.subscribe(args[1] + "_" + (args.length > 3 ? args[3] : ".*"), listener);
        System.out.println("listening");
        System.out.flush();
        listener.waitForAll();
        lcm.close();
    }

    private synchronized void waitForAll() throws InterruptedException {
        while (left > 0) wait();
    }

    @Override
    public synchronized void messageReceived(LCM lcm, String channel, LCMDataInputStream bytes) {
        if (left == 0) return;
        String type = "waymark." + channel.substring(prefix.length() + 1).toLowerCase() + "_t";
        try {
            Constructor<?> decode = Class.forName(type).getConstructor(DataInput.class);
            System.out.println(channel);
            print("  ", decode.newInstance(bytes));
        } catch (ReflectiveOperationException wrong) {
            System.out.println(channel + ": " + wrong + " " + wrong.getCause());
        }
        System.out.flush();
        left -= 1;
        notifyAll();
    }

    private static void print(String indent, Object message) throws IllegalAccessException {
        for (Field field : message.getClass().getFields()) {
            if (Modifier.isStatic(field.getModifiers())) continue;
            print(indent, field.getName(), field.get(message));
        }
    }

    private static void print(String indent, String name, Object value) throws IllegalAccessException {
        if (value.getClass().isArray() && Array.getLength(value) > 0 && isMessage(Array.get(value, 0))) {
            for (int i = 0; i < Array.getLength(value); ++i) {
                System.out.println(indent + name + "[" + i + "]");
                print(indent + "  ", Array.get(value, i));
            }
        } else {
            System.out.println(indent + name + " = " + text(value));
        }
    }

    private static boolean isMessage(Object value) {
        return value.getClass().getName().startsWith("waymark.");
    }

    private static String text(Object value) {
        if (!value.getClass().isArray()) return value.toString();
        StringBuilder line = new StringBuilder("[");
        for (int i = 0; i < Array.getLength(value); ++i) {
            if (i > 0) line.append(", ");
            line.append(text(Array.get(value, i)));
        }
        return line.append("]").toString();
    }
}
